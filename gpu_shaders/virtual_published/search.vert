// Finds the virtual vertex of a vertex, or of one of a grid, and puts it into the table of results.

#include "virtual_published/midpoint.glsl"

uniform int results_height;
uniform int result_shift;  // from a point to its result

in vec3 position;

flat out vec4 found;

void main() {
    found = virtual_vertex(follow(position), position);
    vec2 texel = vec2(texel_at(gl_VertexID + result_shift)) + 0.5;
    gl_Position = vec4(texel / vec2(4096, results_height) * 2.0 - 1.0, 0.0, 1.0);
    gl_PointSize = 1.0;
}
