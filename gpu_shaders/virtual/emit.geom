// The image of a triangle as a rectangle that surely holds it: along its longest side, with a margin.

#include "virtual/screen.glsl"
#include "virtual/results.glsl"
#include "virtual/bundle.glsl"

layout(triangles) in;
layout(triangle_strip, max_vertices = 24) out;

uniform isampler2D sources;  // triangle and instance that each is a piece of
uniform int left_out;        // an instance that is not seen by this path
uniform vec4 bounds;         // pixels that the path is seen in: low and high corner
uniform int first_triangle;

// Tangents at a reflection point that was found. Just beyond a caustic there is none, but there may be for what lies
// beside the vertex.
const float MOST_LEAN = 1e-2, MOST_LEAN_CONCAVE = 0.1;

const float MARGIN = 1.0;      // pixels
const float SURELY = 8.0;      // pixels
const float LARGE = 0.35;      // radians

in vec4 found[];
in vec3 vertex[];
in vec4 shown_there[];
in vec4 found_again[];

out vec2 corner;
flat out ivec2 shown;

void emit(vec2 pixel, ivec2 source) {
    corner = 2.0 * pixel / screen;
    shown = source;
    EmitVertex();
}

void rectangle(vec2 origin, vec2 along, vec2 low, vec2 high) {
    vec2 across = vec2(-along.y, along.x);
    vec2 a = origin + low.x * along + low.y * across, b = origin + high.x * along + low.y * across;
    vec2 c = origin + low.x * along + high.y * across, d = origin + high.x * along + high.y * across;
    vec2 least = min(min(a, b), min(c, d)) + 0.5 * screen, most = max(max(a, b), max(c, d)) + 0.5 * screen;
    if (any(greaterThan(least, bounds.zw)) || any(lessThan(most, bounds.xy))) return;
    ivec2 source = texelFetch(sources, texel_at(first_triangle + gl_PrimitiveIDIn), 0).xy;
    if (source.y == left_out) return;
    emit(a, source);
    emit(b, source);
    emit(c, source);
    emit(d, source);
    EndPrimitive();
}

// The rectangle around three places on the screen, with room for their edges to bend.
void hold(vec3 direction[3], vec4 place[3]) {
    vec3 w = vec3(place[0].z, place[1].z, place[2].z);
    if (all(lessThanEqual(w, vec3(0.0)))) return;
    if (any(lessThanEqual(w, vec3(0.0)))) {
        rectangle(vec2(0.0), vec2(1.0, 0.0), -0.5 * screen, 0.5 * screen);
        return;
    }
    vec2 a = place[0].xy, b = place[1].xy, c = place[2].xy;
    vec3 sides = vec3(distance(a, b), distance(b, c), distance(c, a));
    float longest = max(max(sides.x, sides.y), sides.z);
    vec2 from = longest == sides.x ? a : longest == sides.y ? b : c;
    vec2 to = longest == sides.x ? b : longest == sides.y ? c : a;
    vec2 other = longest == sides.x ? c : longest == sides.y ? a : b;
    vec2 along = longest > 1e-6 ? (to - from) / longest : vec2(1.0, 0.0);
    float height = dot(other - from, vec2(-along.y, along.x));
    float bent = max(max(bend(direction[0], direction[1], a, b), bend(direction[1], direction[2], b, c)),
                     bend(direction[2], direction[0], c, a));
    float around = MARGIN + bent;
    rectangle(from, along, vec2(0.0, min(height, 0.0)) - around, vec2(longest, max(height, 0.0)) + around);
}

bool is_found(vec4 result) {
    return result.w >= 0.0 && result.w <= (concave ? MOST_LEAN_CONCAVE : MOST_LEAN);
}

// Whether the corners' reflection points are so near to each other that they surely belong to the same image.
bool together(vec4 place[3]) {
    vec2 a = place[0].xy, b = place[1].xy, c = place[2].xy;
    return max(max(distance(a, b), distance(b, c)), distance(c, a)) <= SURELY;
}

// The image that a corner's result belongs to: the others' reflection points are looked for beside it.
void image_of(int corner, vec3 result, out vec3 direction[3], out vec4 place[3]) {
    for (int i = 0; i < 3; ++i) {
        direction[i] = i == corner ? result : search(result, vertex[i]).xyz;
        place[i] = shown_at(direction[i]);
    }
}

void main() {
    vec3 middle = (vertex[0] + vertex[1] + vertex[2]) / 3.0;
    float radius = max(max(distance(middle, vertex[0]), distance(middle, vertex[1])), distance(middle, vertex[2]));
    if (!in_bundle(middle, radius)) return;
    // For its distance from where the rays begin, about in radians.
    float size = 2.0 * radius / max(max(distance(middle, bundle.xyz), bundle.w), 1e-9);
    vec4 result[6] = vec4[6](found[0], found[1], found[2], found_again[0], found_again[1], found_again[2]);
    bool more = is_found(result[3]) || is_found(result[4]) || is_found(result[5]);
    bvec3 has = bvec3(is_found(result[0]), is_found(result[1]), is_found(result[2]));
    vec3 direction[3] = vec3[3](found[0].xyz, found[1].xyz, found[2].xyz);
    vec4 place[3] = shown_there;
    vec2 middles[6];
    int images = 0;
    if (is_whole(0) && ORDER == 1 || all(has) && together(place)) {
        if (!any(has)) return;
        hold(direction, place);
        if (!more) return;
        middles[images++] = (place[0].xy + place[1].xy + place[2].xy) / 3.0;
    } else if (!all(has) && size > LARGE) {
        // Its corners lie far outside of what is seen, which it may fill.
        rectangle(vec2(0.0), vec2(1.0, 0.0), bounds.xy - 0.5 * screen, bounds.zw - 0.5 * screen);
        return;
    }
    // A mirror that is not convex may show a triangle more than once, each corner in another image.
    for (int i = 0; i < 6; ++i) {
        if (!is_found(result[i])) continue;
        image_of(i % 3, result[i].xyz, direction, place);
        vec2 image = (place[0].xy + place[1].xy + place[2].xy) / 3.0;
        bool known = false;
        for (int j = 0; j < images; ++j) known = known || distance(image, middles[j]) < 1.0;
        if (known) continue;
        middles[images++] = image;
        hold(direction, place);
    }
}
