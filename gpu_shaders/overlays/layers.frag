// Debug view of the layered depth textures: how many layers the column below each point of a surface has.

#include "common/picture.glsl"
#include "common/layers.glsl"

uniform float weight;

layout(location = 0) out vec4 color;

// The finest node of the column that `place` (0..1 in the box) lies in.
uvec2 column_at(ivec4 grid, vec2 place) {
    ivec2 shape = grid.xy;
    int first_block = grid.w;
    for (int level = grid.z - 1; level > 0;) first_block -= blocks_at(shape, --level);
    ivec2 column = clamp(ivec2(place * vec2(shape)), ivec2(0), shape - 1);
    return texelFetch(layer_nodes, texel_at(first_block + column.x + shape.x * column.y), 0).xy;
}

// Neighbouring slices belong to one layer: counts where a run of them begins.
int layers_in(uvec2 slices) {
    uvec2 before = uvec2(slices.x << 1, (slices.y << 1) | (slices.x >> 31));
    return bitCount(slices.x & ~before.x) + bitCount(slices.y & ~before.y);
}

void main() {
    Hit hit = pixel_hit(pixel_ray());
    if (hit.instance == NONE) discard;
    Triangle t = triangle_at(hit.triangle);
    vec3 weights = vec3(1.0 - hit.barycentric.x - hit.barycentric.y, hit.barycentric);
    vec4 low = instance_texel(hit.instance, 7);
    vec3 place = (mat3(t.a, t.b, t.c) * weights - low.xyz) / instance_texel(hit.instance, 8).xyz;
    place = low.w == 0.0 ? place.yzx : low.w == 1.0 ? place.zxy : place;
    color = weight * vec4(layers_in(column_at(grid_of(hit.instance), place.xy)));
}
