// SPDX-FileCopyrightText: 2026 The Catoptric authors
// SPDX-License-Identifier: 0BSD
//
// Reflections from what `catoptric export-engine` wrote. Paste this below `#version 330 core` or later; it
// needs nothing else. catoptric.json beside it names the textures and holds the numbers.
//
// World space is right-handed, Z up, in metres; radiance is scene-linear. Upload every texture with its first
// row first, as the files hold them. An engine that turns pictures over while it loads them sets
// CATOPTRIC_ROWS_FROM_BOTTOM to 1 above this file.
//
//     CatoptricHit hit = catoptric_trace(color_depth, normal_count, object, origin, direction);  // each object
//     vec3 radiance = hit.distance < CATOPTRIC_FAR ? hit.radiance : catoptric_cube(picture, direction);

#ifndef CATOPTRIC_ROWS_FROM_BOTTOM
#define CATOPTRIC_ROWS_FROM_BOTTOM 0
#endif

// Equal steps through an object's box: parts thinner than one may be stepped over. Then halvings of the last.
#ifndef CATOPTRIC_LINEAR_STEPS
#define CATOPTRIC_LINEAR_STEPS 32
#endif
#ifndef CATOPTRIC_BINARY_STEPS
#define CATOPTRIC_BINARY_STEPS 8
#endif

// Texels between ray and surface, along a face's depth, at which no further face is searched.
#ifndef CATOPTRIC_THRESHOLD
#define CATOPTRIC_THRESHOLD 1.0
#endif

const float CATOPTRIC_FAR = 1e30;

// ---------------------------------------------------------------- layered depth textures (objects)
//
// Six orthographic views of an object's box, peeled layer by layer (Zhang, Hsieh and Shen, 3.3 and 3.4).
// Textures: two arrays of 32-bit float RGBA, one slice a layer, the nearest first, read without filtering.
//
//     color_depth   RGB radiance, A depth: 0 at the face to 1 at the opposite one
//     normal_count  RGB normal in the object's space, A layers of the texel (the same in every slice)
//
// Where a layer leaves the object again is what the opposite face sees there as a layer of its own.

// An object where it stands. Of its entry in catoptric.json:
struct CatoptricObject {
    mat4 world_to_object;  // the inverse of an instance's object_to_world
    vec3 low, size;        // box.low and box.size: metres, in the object's space
    ivec3 texels;          // texels along the sides of the box
};

struct CatoptricHit {
    float distance;  // in lengths of the ray's direction; CATOPTRIC_FAR for nothing
    vec3 radiance;
    vec3 normal;     // in the world, of unit length
};

// One of the six views: along `axis` (0 to 2), from its high end or its low one.
struct CatoptricFace {
    int axis;
    bool high;
    ivec2 shape;  // columns and rows of texels, along the two axes after its own
    int cell;     // texels along a cell of the atlas
};

CatoptricFace catoptric_face(CatoptricObject object, int axis, bool high) {
    ivec2 shape = ivec2(object.texels[(axis + 1) % 3], object.texels[(axis + 2) % 3]);
    return CatoptricFace(axis, high, shape, max(object.texels.x, max(object.texels.y, object.texels.z)));
}

CatoptricFace catoptric_opposite(CatoptricFace face) {
    return CatoptricFace(face.axis, !face.high, face.shape, face.cell);
}

// Where the atlas shows `place` (0 to 1 in the box): faces +X +Y +Z in a row above -X -Y -Z, each at the lower
// left of its cell.
ivec2 catoptric_texel(CatoptricFace face, vec3 place) {
    vec2 across = vec2(place[(face.axis + 1) % 3], place[(face.axis + 2) % 3]);
    ivec2 texel = clamp(ivec2(across * vec2(face.shape)), ivec2(0), face.shape - 1);
    int from_bottom = (face.high ? 1 : 0) * face.cell + texel.y;
    int row = CATOPTRIC_ROWS_FROM_BOTTOM == 1 ? from_bottom : 2 * face.cell - 1 - from_bottom;
    return ivec2(face.axis * face.cell + texel.x, row);
}

int catoptric_count(sampler2DArray normal_count, ivec2 texel) {
    return min(int(texelFetch(normal_count, ivec3(texel, 0), 0).a), textureSize(normal_count, 0).z);
}

// How deep a place lies behind its face.
float catoptric_height(CatoptricFace face, vec3 place) {
    return face.high ? 1.0 - place[face.axis] : place[face.axis];
}

float catoptric_entry(sampler2DArray color_depth, CatoptricFace face, vec3 place, int layer) {
    return texelFetch(color_depth, ivec3(catoptric_texel(face, place), layer), 0).a;
}

// The layer that `place` lies in, -1 for none: Algorithm 1, lines 3 to 17.
int catoptric_layer(sampler2DArray color_depth, sampler2DArray normal_count, CatoptricFace face, vec3 place) {
    float h = catoptric_height(face, place);
    int count = catoptric_count(normal_count, catoptric_texel(face, place));
    for (int layer = 0; layer < count; ++layer) {
        if (h < catoptric_entry(color_depth, face, place, layer)) return -1;
        float behind = 1.0 - catoptric_entry(color_depth, catoptric_opposite(face), place, count - 1 - layer);
        if (h <= behind) return layer;
    }
    return -1;
}

// Marches from `a` to `b` (0 to 1 in the box): equal steps to the first place inside, then halves of the last
// one. Returns how far between the two (0 to 1), and sets the layer, -1 for none.
float catoptric_march(sampler2DArray color_depth, sampler2DArray normal_count, CatoptricFace face,
                      vec3 a, vec3 b, out int layer) {
    float before = 0.0, at = 0.0;
    layer = -1;
    for (int i = 0; i <= CATOPTRIC_LINEAR_STEPS && layer < 0; ++i) {
        before = at;
        at = float(i) / float(CATOPTRIC_LINEAR_STEPS);
        layer = catoptric_layer(color_depth, normal_count, face, mix(a, b, at));
    }
    if (layer < 0) return 1.0;
    for (int i = 0; i < CATOPTRIC_BINARY_STEPS; ++i) {
        float middle = 0.5 * (before + at);
        vec3 place = mix(a, b, middle);
        bool covered = layer < catoptric_count(normal_count, catoptric_texel(face, place));
        if (covered && catoptric_height(face, place) > catoptric_entry(color_depth, face, place, layer)) at = middle;
        else before = middle;
    }
    return at;
}

// What a ray meets of an object. Searches up to three faces, the one that the ray enters by first, and keeps
// the one whose layer lies nearest to the ray. Of several objects, the least distance is seen.
CatoptricHit catoptric_trace(sampler2DArray color_depth, sampler2DArray normal_count, CatoptricObject object,
                             vec3 origin, vec3 direction) {
    CatoptricHit hit = CatoptricHit(CATOPTRIC_FAR, vec3(0.0), vec3(0.0));
    vec3 start = ((object.world_to_object * vec4(origin, 1.0)).xyz - object.low) / object.size;
    vec3 along = (object.world_to_object * vec4(direction, 0.0)).xyz / object.size;
    vec3 inverse = 1.0 / mix(along, vec3(1e-30), lessThan(abs(along), vec3(1e-30)));
    vec3 enters = min(-start * inverse, (1.0 - start) * inverse);
    vec3 leaves = max(-start * inverse, (1.0 - start) * inverse);
    float first = max(max(enters.x, max(enters.y, enters.z)), 0.0), last = min(leaves.x, min(leaves.y, leaves.z));
    if (first >= last) return hit;
    vec3 a = start + first * along, b = start + last * along;

    int nearest = enters.x >= enters.y && enters.x >= enters.z ? 0 : enters.y >= enters.z ? 1 : 2;
    float least = CATOPTRIC_FAR;
    for (int i = 0; i < 3 && least > CATOPTRIC_THRESHOLD; ++i) {
        int axis = (nearest + i) % 3, layer;
        if (along[axis] == 0.0) continue;
        CatoptricFace face = catoptric_face(object, axis, along[axis] < 0.0);
        float at = catoptric_march(color_depth, normal_count, face, a, b, layer);
        vec3 place = mix(a, b, at);
        if (layer < 0) continue;
        float error = abs(catoptric_height(face, place) - catoptric_entry(color_depth, face, place, layer))
                      * float(object.texels[axis]);
        if (error >= least) continue;
        least = error;
        ivec3 texel = ivec3(catoptric_texel(face, place), layer);
        vec3 normal = texelFetch(normal_count, texel, 0).xyz * mat3(object.world_to_object);
        hit = CatoptricHit(mix(first, last, at), texelFetch(color_depth, texel, 0).rgb, normalize(normal));
    }
    return hit;
}

// ---------------------------------------------------------------- environment cubes (reflectors)
//
// What a reflector sees from its centre, but for itself and the objects that have layered depth textures.
// Cube maps have an orientation of their own: left-handed, Y up, Z ahead. A direction of the world turns into
// one of theirs by swapping Y and Z, and so a samplerCube made of the six faces wants texture(cube, world.xzy).
//
//          +Y                  up
//      -X  +Z  +X  -Z     -X   +Y   +X   -Y  of the world
//          -Y                 down

// Radiance from a direction of the world, of any length. `picture` is the cross, filtered linearly.
vec3 catoptric_cube(sampler2D picture, vec3 direction) {
    vec3 d = direction.xzy, size = abs(d), side = mix(vec3(1.0), vec3(-1.0), lessThan(d, vec3(0.0)));
    vec2 cell, place;  // of the cross: columns and rows; of the face: -1 to 1, rightwards and downwards
    if (size.x >= size.y && size.x >= size.z) {
        cell = vec2(1.0 + side.x, 1.0);
        place = vec2(-side.x * d.z, -d.y) / size.x;
    } else if (size.y >= size.z) {
        cell = vec2(1.0, 1.0 - side.y);
        place = vec2(d.x, side.y * d.z) / size.y;
    } else {
        cell = vec2(2.0 - side.z, 1.0);
        place = vec2(side.z * d.x, -d.y) / size.z;
    }
    float texels = float(textureSize(picture, 0).x / 4);
    vec2 within = clamp((0.5 + 0.5 * place) * texels, 0.5, texels - 0.5);  // never across the border of a face
    vec2 at = (cell * texels + within) / vec2(textureSize(picture, 0));
    return textureLod(picture, CATOPTRIC_ROWS_FROM_BOTTOM == 1 ? vec2(at.x, 1.0 - at.y) : at, 0.0).rgb;
}
