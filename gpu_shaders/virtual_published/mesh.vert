// A vertex of a virtual mesh: its own result, or between those of the corners of its cell: where GRID is 1 in one as
// published (Estalella et al., 5), where it is 2 in one of the grid that was refined for the view, if it has one there.

#include "common/data.glsl"

uniform sampler2D results;  // xyz: virtual vertex, w: 1 where that is hidden, 2 where there is none
uniform int result_shift;   // from a point to its result, or a vertex to its cell

in vec3 position;           // in the world
#if GRID
uniform isampler2D cells;   // 2 texels a cell: the points at its corners, x fastest; of a refined grid, their results
#endif
#if GRID == 1
in int cell;
in vec3 place;              // in the cell, 0 to 1
#elif GRID == 2
uniform isampler2D vertex_cells;  // the cell, plus 1, or below 1 the result
uniform sampler2D cell_boxes;     // 2 texels a cell: low and high corner
#endif

out vec4 image;
out vec3 original;

vec4 result_of(int point) {
    return texelFetch(results, texel_at(point), 0);
}

#if GRID
vec4 along_x(ivec2 points, vec3 place) {
    return mix(result_of(points.x), result_of(points.y), place.x);
}

vec4 layer(ivec4 points, vec3 place) {
    return mix(along_x(points.xy, place), along_x(points.zw, place), place.y);
}

vec4 in_cell(int cell, vec3 place, int shift) {
    return mix(layer(texelFetch(cells, texel_at(2 * cell), 0) + shift, place),
               layer(texelFetch(cells, texel_at(2 * cell + 1), 0) + shift, place), place.z);
}
#endif

void main() {
    original = position;
#if GRID == 0
    image = result_of(gl_VertexID + result_shift);
#elif GRID == 1
    image = in_cell(cell, place, result_shift);
#else
    int told = texelFetch(vertex_cells, texel_at(gl_VertexID + result_shift), 0).x;
    if (told <= 0) {
        image = result_of(-told);
    } else {
        vec3 low = texelFetch(cell_boxes, texel_at(2 * told - 2), 0).xyz;
        vec3 size = texelFetch(cell_boxes, texel_at(2 * told - 1), 0).xyz - low;
        image = in_cell(told - 1, clamp((position - low) / max(size, vec3(1e-30)), 0.0, 1.0), 0);
    }
#endif
}
