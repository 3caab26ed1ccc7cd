// A vertex and its reflection point.

#include "virtual/results.glsl"

uniform sampler2D results;
uniform sampler2D results_shown;
uniform sampler2D results_again;
uniform int result_shift;  // from a point to its result

in vec3 position;

out vec3 vertex;
out vec4 found;
out vec4 shown_there;
out vec4 found_again;

void main() {
    ivec2 texel = texel_at(gl_VertexID + result_shift);
    vertex = position;
    found = texelFetch(results, texel, 0);
    found_again = texelFetch(results_again, texel, 0);
    shown_there = texelFetch(results_shown, texel, 0);
}
