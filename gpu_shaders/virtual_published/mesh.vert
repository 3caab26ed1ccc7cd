// A vertex of a virtual mesh: its own result, or where GRID is 1 between those of the corners of its cell
// (Estalella et al., 5).

#include "common/data.glsl"

uniform sampler2D results;  // xyz: virtual vertex, w: 1 where that is hidden or unreflected
uniform int result_shift;   // from a point to its result

in vec3 position;           // in the world
#if GRID
uniform isampler2D cells;   // 2 texels a cell: the points at its corners, x fastest

in int cell;
in vec3 place;              // in the cell, 0 to 1
#endif

out vec4 image;
out vec3 original;

vec4 result_of(int point) {
    return texelFetch(results, texel_at(point + result_shift), 0);
}

#if GRID
vec4 along_x(ivec2 points) {
    return mix(result_of(points.x), result_of(points.y), place.x);
}

vec4 layer(ivec4 points) {
    return mix(along_x(points.xy), along_x(points.zw), place.y);
}
#endif

void main() {
    original = position;
#if GRID
    image = mix(layer(texelFetch(cells, texel_at(2 * cell), 0)),
                  layer(texelFetch(cells, texel_at(2 * cell + 1), 0)), place.z);
#else
    image = result_of(gl_VertexID);
#endif
}
