// Neighbourhood pixel searching (Xie et al., 3.2.1, Algorithm 2): where in the key frame the reflection of each of its
// pixels has moved to, as an offset in pixels.

#include "reprojection_published/distance.glsl"

uniform isampler2D previous;  // offsets for the picture before
uniform bool is_first;        // there is none
uniform int most_steps;

layout(location = 0) out ivec2 offset;

const float NOT_THERE = 1e30;

// The best of the eight pixels around one. Algorithm 2 goes on while this is not worse; on a plateau that would not
// end, so here it must be better.
ivec2 best_beside(ivec2 pixel, vec3 point, out float least) {
    ivec2 best = pixel;
    least = NOT_THERE;
    for (int i = 0; i < 9; ++i) {
        ivec2 beside = pixel + ivec2(i % 3, i / 3) - 1;
        if (i == 4 || depth_at(beside) <= 0.0) continue;
        float there = distance_of(known_at(beside), point);
        if (there < least) {
            least = there;
            best = beside;
        }
    }
    return best;
}

// Whether a pixel is inside the silhouette of a mirror: that is where the depth jumps, and where the picture ends.
bool is_inside(ivec2 pixel) {
    vec4 here = texelFetch(known_geometry, pixel, 0);
    if (here.w <= 0.0) return false;
    for (int i = 0; i < 9; ++i)
        if (is_cut(here.z, depth_at(pixel + ivec2(i % 3, i / 3) - 1))) return false;
    return true;
}

ivec2 matched(ivec2 pixel, ivec2 start, vec3 point) {
    ivec2 at = start;
    float former = distance_of(known_at(at), point);
    for (int i = 0; i < most_steps; ++i) {
        float least;
        ivec2 best = best_beside(at, point, least);
        if (least >= former) return is_inside(at) ? at - pixel : ivec2(INVALID);
        if (is_cut(depth_at(at), depth_at(best))) return ivec2(INVALID);
        former = least;
        at = best;
    }
    return ivec2(INVALID);
}

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    Known s = known_at(pixel);
    offset = ivec2(INVALID);
    if (s.specular <= 0.0) return;
    vec3 point = s.position + light_known_at(pixel).a * reflect(s.direction, s.normal);
    ivec2 before = is_first ? ivec2(INVALID) : texelFetch(previous, pixel, 0).xy;
    offset = matched(pixel, before.x == INVALID ? pixel : pixel + before, point);
}
