// Finds the reflection point of a vertex, and puts it into the table of results.

#include "virtual/screen.glsl"
#include "virtual/results.glsl"
#include "virtual/bundle.glsl"

uniform int results_height;
uniform int result_shift;  // from a point to its result

const float ELSEWHERE = 0.3, SAME = 0.02;  // of the tangent that a face reaches to

in vec3 position;

flat out vec4 found;
flat out vec4 shown;
flat out vec4 found_again;

// From where a ray begins that is away from the first result.
vec4 search_again(vec3 away_from, vec3 vertex) {
    vec3 start = sample_starts[nearest_sample(vertex, away_from, ELSEWHERE * part_reaches[0])];
    vec4 result = search(start, vertex);
    return distance(result.xyz, away_from) < SAME * part_reaches[0] ? NOT_SOUGHT : result;
}

void main() {
    found = NOT_SOUGHT;
    shown = vec4(0.0);
    found_again = NOT_SOUGHT;
    if (in_bundle(position, 0.0)) {
        found = search(position);
        shown = shown_at(found.xyz);
        if (concave) found_again = search_again(found.xyz, position);
    }
    vec2 texel = vec2(texel_at(gl_VertexID + result_shift)) + 0.5;
    gl_Position = vec4(texel / vec2(4096, results_height) * 2.0 - 1.0, 0.0, 1.0);
    gl_PointSize = 1.0;
}
