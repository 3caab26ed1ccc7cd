// Finds the reflection point of a vertex, and puts it into the table of results.

#include "virtual/screen.glsl"
#include "virtual/results.glsl"
#include "virtual/bundle.glsl"

uniform int results_height;
uniform int result_shift;  // from a point to its result
uniform bool known;        // whether the frame before has found something for these points
uniform int last_shift;    // and from a point to that
uniform sampler2D results;
uniform sampler2D results_again;

const float ELSEWHERE = 0.3, SAME = 0.02;  // of the tangent that a face reaches to
const float REACHED = 1e-2;                // as a tangent: how far the bisector may lean where a search has ended well

in vec3 position;

flat out vec4 found;
flat out vec4 shown;
flat out vec4 found_again;

bool is_reached(vec4 result) {
    return result.w >= 0.0 && result.w <= REACHED;
}

// From where a search ended in the last frame, or else from the beginning.
vec4 search_on(vec3 vertex, ivec2 last) {
    if (known) {
        vec4 before = texelFetch(results, last, 0);
        vec4 result = is_reached(before) ? search(before.xyz, vertex) : NOT_SOUGHT;
        if (is_reached(result)) return result;
    }
    return search(vertex);
}

// From where a ray begins that is away from the first result, or where this search ended in the last frame.
vec4 search_again(vec3 away_from, vec3 vertex, ivec2 last) {
    if (known) {
        vec4 before = texelFetch(results_again, last, 0);
        vec4 result = is_reached(before) ? search(before.xyz, vertex) : NOT_SOUGHT;
        if (is_reached(result) && distance(result.xyz, away_from) >= SAME * part_reaches[0]) return result;
    }
    vec3 start = sample_starts[nearest_sample(vertex, away_from, ELSEWHERE * part_reaches[0])];
    vec4 result = search(start, vertex);
    return distance(result.xyz, away_from) < SAME * part_reaches[0] ? NOT_SOUGHT : result;
}

void main() {
    found = NOT_SOUGHT;
    shown = vec4(0.0);
    found_again = NOT_SOUGHT;
    if (in_bundle(position, 0.0)) {
        ivec2 last = texel_at(gl_VertexID + last_shift);
        found = search_on(position, last);
        shown = shown_at(found.xyz);
        if (concave) found_again = search_again(found.xyz, position, last);
    }
    vec2 texel = vec2(texel_at(gl_VertexID + result_shift)) + 0.5;
    gl_Position = vec4(texel / vec2(4096, results_height) * 2.0 - 1.0, 0.0, 1.0);
    gl_PointSize = 1.0;
}
