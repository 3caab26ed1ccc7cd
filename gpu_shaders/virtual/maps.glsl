// Reflector cube maps (Estalella et al., 4.1; addon/baking/reflector_maps.py) of the parts that a path is
// reflected at: ORDER of them, one after another.

#include "common/data.glsl"

uniform sampler2D map_texels;         // 2 texels a texel: position | normal, in the part's frame
#ifdef MANY_PARTS
#define CHOSEN                        // by choose_part
#else
#define CHOSEN uniform
#endif
CHOSEN ivec3 part_maps[ORDER];        // first texel; texels along a face; faces, 6 or 1
CHOSEN float part_reaches[ORDER];     // tangent of the angle between a face's middle and its side
CHOSEN mat4 part_to_world[ORDER];
CHOSEN mat3 normal_to_world[ORDER];
CHOSEN float part_bends[ORDER];       // below 0 for a concave part

#ifdef MANY_PARTS
uniform sampler2D part_rows;          // 8 texels a part

// Have what follows be about a part, known by its number.
void choose_part(int number) {
    vec4 row[8];
    for (int i = 0; i < 8; ++i) row[i] = texelFetch(part_rows, texel_at(8 * (number - 1) + i), 0);
    part_maps[0] = ivec3(int(row[0].x) << 12 | int(row[0].y), ivec2(row[0].zw));
    part_to_world[0] = mat4(row[1], row[2], row[3], row[4]);
    normal_to_world[0] = mat3(row[5].xyz, row[6].xyz, row[7].xyz);
    part_reaches[0] = row[5].w;
    part_bends[0] = row[6].w;
}
#endif

const float BORDER = 1.0;
const float MOST_OUTSIDE = 1.5;       // how far beyond its side a patch is continued, in halves of it

// A point of a face: `at` is -1 to 1 within the face's border times the tangent it reaches to.
struct Place {
    int face;
    vec2 at;
};

// The reflector there and how it goes on along the face: per unit of `at`. World space; the normal is not of
// unit length.
struct Point {
    vec3 position, along_u, along_v;
    vec3 normal, normal_u, normal_v;
};

int largest_axis(vec3 v) {
    vec3 size = abs(v);
    return size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
}

// Where a direction of the part's frame meets its maps; a patch has the face +Z alone.
Place place_of(int part, vec3 direction) {
    int axis = part_maps[part].z == 1 ? 2 : largest_axis(direction);
    float side = direction[axis] < 0.0 ? -1.0 : 1.0;
    float ahead = max(abs(direction[axis]), 1e-6);
    return Place(2 * axis + (side < 0.0 ? 1 : 0),
                 vec2(-side * direction[(axis + 1) % 3], direction[(axis + 2) % 3]) / ahead);
}

vec3 direction_of(Place place) {
    int axis = place.face / 2;
    float side = place.face % 2 == 0 ? 1.0 : -1.0;
    vec3 direction;
    direction[axis] = side;
    direction[(axis + 1) % 3] = -side * place.at.x;
    direction[(axis + 2) % 3] = place.at.y;
    return normalize(direction);
}

mat2x3 map_texel(int first, int index) {
    return mat2x3(texelFetch(map_texels, texel_at(2 * (first + index)), 0).xyz,
                  texelFetch(map_texels, texel_at(2 * (first + index) + 1), 0).xyz);
}

// How far a point lies above the tangent plane of a texel.
vec3 above(vec3 point, mat2x3 texel) {
    return dot(point - texel[0], texel[1]) * texel[1];
}

Point point_at(int part, Place place) {
    ivec3 map = part_maps[part];
    int first = map.x + (map.z == 1 ? 0 : place.face * map.y * map.y);
    float half_face = 0.5 * (float(map.y) - 2.0 * BORDER);
    float scale = half_face / part_reaches[part];
    vec2 most = map.z == 1 ? vec2(MOST_OUTSIDE * half_face) : vec2(half_face + 0.5);
    vec2 at = clamp(scale * place.at, -most, most) + half_face + 0.5 * (2.0 * BORDER - 1.0);
    ivec2 cell = clamp(ivec2(floor(at)), ivec2(0), ivec2(map.y - 2));
    vec2 share = at - vec2(cell);
    int index = cell.x + map.y * cell.y;
    mat2x3 a = map_texel(first, index), b = map_texel(first, index + 1);
    mat2x3 c = map_texel(first, index + map.y), d = map_texel(first, index + map.y + 1);
    mat2x3 low = a + share.x * (b - a), high = c + share.x * (d - c);
    mat2x3 u = scale * ((1.0 - share.y) * (b - a) + share.y * (d - c)), v = scale * (high - low);
    mat2x3 here = low + share.y * (high - low);
    // The mean of the plane between the corners and their tangent planes is right to the second order
    // (after Boubekeur and Alexa, *Phong tessellation*, 2008).
    here[0] -= 0.5 * mix(mix(above(here[0], a), above(here[0], b), share.x),
                         mix(above(here[0], c), above(here[0], d), share.x), share.y);
    mat3 outward = mat3(part_to_world[part]);
    return Point((part_to_world[part] * vec4(here[0], 1.0)).xyz, outward * u[0], outward * v[0],
                 normal_to_world[part] * here[1], normal_to_world[part] * u[1], normal_to_world[part] * v[1]);
}
