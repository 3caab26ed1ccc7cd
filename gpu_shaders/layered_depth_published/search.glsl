// The search of one object's layered depth textures, as Zhang et al. publish it (3.3, 3.4).

#include "common/layers.glsl"

uniform usampler2D peeled_objects;  // 4 texels an instance: whether baked | of each axis: columns, rows, first texel
uniform sampler2D peeled_boxes;     // 2 texels an instance: low corner | size
uniform usampler2D peeled_texels;   // first layer, layers
uniform sampler2D peeled_layers;    // 2 texels a layer: color, depth of its entry | of its exit

uniform int most_layers;            // that a face sees
uniform int linear_steps;
uniform int binary_steps;
uniform float threshold;            // texels between ray and surface that count as a hit

// One of the six textures. The two of an axis hold the same layers, the high one last first.
struct Face {
    int axis;
    bool high;
    ivec2 shape;
    int first;
    float depth_texels;  // depth of the box, in texels
};

// Where the ray meets a face's layers: `at` 0 (entry of the box) to 1 (exit), `layer` NONE for nowhere,
// `error` texels between the ray's depth and the layer's.
struct Met {
    float at;
    int layer;
    float error;
};

Face face_of(int instance, int axis, bool high) {
    uvec3 grid = texelFetch(peeled_objects, texel_at(4 * instance + 1 + axis), 0).xyz;
    vec3 size = texelFetch(peeled_boxes, texel_at(2 * instance + 1), 0).xyz;
    return Face(axis, high, ivec2(grid.xy), int(grid.z), size[axis] / size[(axis + 1) % 3] * float(grid.x));
}

// First layer and number of layers of the texel that `place` (0..1 in the box) lies in.
ivec2 layers_at(Face face, vec3 place) {
    vec2 across = vec2(place[(face.axis + 1) % 3], place[(face.axis + 2) % 3]);
    ivec2 texel = clamp(ivec2(across * vec2(face.shape)), ivec2(0), face.shape - 1);
    return ivec2(texelFetch(peeled_texels, texel_at(face.first + texel.x + face.shape.x * texel.y), 0).xy);
}

int row_of(Face face, ivec2 layers, int layer) {
    return layers.x + (face.high ? layers.y - 1 - layer : layer);
}

// Depth of entry and exit, from this face on.
vec2 depths_of(Face face, ivec2 layers, int layer) {
    int row = row_of(face, layers, layer);
    float enters = texelFetch(peeled_layers, texel_at(2 * row), 0).w;
    float leaves = texelFetch(peeled_layers, texel_at(2 * row + 1), 0).w;
    return face.high ? 1.0 - vec2(leaves, enters) : vec2(enters, leaves);
}

vec3 color_at(Face face, vec3 place, int layer) {
    int row = row_of(face, layers_at(face, place), layer);
    return texelFetch(peeled_layers, texel_at(2 * row + (face.high ? 1 : 0)), 0).rgb;
}

float height_of(Face face, vec3 place) {
    return face.high ? 1.0 - place[face.axis] : place[face.axis];
}

// Algorithm 1, lines 3 to 17: the layer that `place` lies in. Before a layer's entry it is outside,
// past its exit the next layer may hold it.
int layer_around(Face face, vec3 place) {
    float h = height_of(face, place);
    ivec2 layers = layers_at(face, place);
    int count = min(layers.y, most_layers), j = 0;
    if (count == 0) return NONE;
    vec2 depth;
    do depth = depths_of(face, layers, j); while (h > depth.y && ++j < count);
    return j < count && h >= depth.x ? j : NONE;
}

// Behind the entry of a layer that the linear search has found.
bool is_behind(Face face, vec3 place, int layer) {
    ivec2 layers = layers_at(face, place);
    return layer < layers.y && height_of(face, place) > depths_of(face, layers, layer).x;
}

// From `a` to `b`, where the ray enters and leaves the box (0..1 in it): equal steps to the first
// point inside, then halves of the last one.
Met search_face(Face face, vec3 a, vec3 b) {
    float before = 0.0, at = 0.0;
    int layer, i = 0;
    do {
        before = at;
        at = float(i) / float(linear_steps);
        layer = layer_around(face, mix(a, b, at));
    } while (layer == NONE && ++i <= linear_steps);
    if (layer == NONE) return Met(1.0, NONE, FAR);
    for (int i = 0; i < binary_steps; ++i) {
        float middle = 0.5 * (before + at);
        if (is_behind(face, mix(a, b, middle), layer)) at = middle; else before = middle;
    }
    vec3 place = mix(a, b, at);
    float z = depths_of(face, layers_at(face, place), layer).x;
    return Met(at, layer, abs(height_of(face, place) - z) * face.depth_texels);
}

struct Found {
    vec3 radiance;
    float distance;  // metres; FAR for nothing
};

// Searches up to three faces, the one that the ray enters by first, and keeps the one whose layer
// fits the ray best; stops at one that fits within the threshold.
Found search_object(int instance, Ray world) {
    Found found = Found(vec3(0.0), FAR);
    mat4x3 inward = world_to_object(instance);
    vec3 low = texelFetch(peeled_boxes, texel_at(2 * instance), 0).xyz;
    vec3 size = texelFetch(peeled_boxes, texel_at(2 * instance + 1), 0).xyz;
    vec3 origin = (inward * vec4(world.origin, 1.0) - low) / size, direction = mat3(inward) * world.direction / size;
    vec3 inverse = safe_inverse(direction);
    vec2 span = box_span(origin, inverse, vec3(0.0), vec3(1.0));
    span.x = max(span.x, 0.0);
    if (span.x >= span.y) return found;
    vec3 a = origin + span.x * direction, b = origin + span.y * direction;

    vec3 entries = min(-origin * inverse, (1.0 - origin) * inverse);
    int first = entries.x >= entries.y && entries.x >= entries.z ? 0 : entries.y >= entries.z ? 1 : 2;
    float least = FAR;
    int i = 0;
    do {
        int axis = (first + i) % 3;
        if (direction[axis] == 0.0) continue;
        Face face = face_of(instance, axis, direction[axis] < 0.0);
        Met met = search_face(face, a, b);
        if (met.layer == NONE || met.error >= least) continue;
        least = met.error;
        found = Found(color_at(face, mix(a, b, met.at), met.layer), mix(span.x, span.y, met.at));
    } while (++i < 3 && least > threshold);
    return found;
}
