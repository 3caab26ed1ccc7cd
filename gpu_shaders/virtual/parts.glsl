// The parts of reflectors (addon/baking/reflector_maps_tables.py).

#include "common/data.glsl"

// 1 texel an instance: where its triangles' parts begin | which of the reflectors it is; then 1 a triangle: its part |
// whether that is a whole body
uniform usampler2D part_numbers;

uvec2 part_texel(int instance, int triangle) {
    uint start = texelFetch(part_numbers, texel_at(instance), 0).x;
    return texelFetch(part_numbers, texel_at(int(start + uint(triangle))), 0).xy;
}

// Counts all reflectors of the scene, in the order of their instances.
int ordinal_of(int instance) {
    return int(texelFetch(part_numbers, texel_at(instance), 0).y);
}
