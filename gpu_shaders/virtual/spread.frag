// What a pixel's mirrored ray meets, among that and what the rays of pixels around it meet. Where an image is
// stretched, near a caustic, a triangle may reach further than the rectangle around its corners' images.

#include "virtual/met.glsl"
#include "virtual/seen.glsl"

uniform usampler2D virtual_objects;
uniform int stride;  // pixels

out uvec2 nearest;

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy), size = textureSize(virtual_objects, 0);
    vec4 origin = texelFetch(ray_origins, pixel, 0);
    if (origin.w == 0.0) discard;
    float before = texelFetch(ray_directions, pixel, 0).w, least = FAR_AWAY;
    nearest = texelFetch(virtual_objects, pixel, 0).xy;
    if (nearest.x == NOT_SEARCHED) return;
    nearest = uvec2(WORLD_SEEN, 0u);
    uvec2 last = uvec2(0u);
    for (int i = 0; i < 9; ++i) {
        ivec2 other = pixel + stride * (ivec2(i % 3, i / 3) - 1);
        if (any(lessThan(other, ivec2(0))) || any(greaterThanEqual(other, size))) continue;
        uvec2 seen = texelFetch(virtual_objects, other, 0).xy;
        bool nothing = seen.x == NOT_SEARCHED || seen.x == WORLD_SEEN;
        bool elsewhere = texelFetch(ray_origins, other, 0).w != origin.w
                      || texelFetch(ray_directions, other, 0).w != before;
        if (nothing || elsewhere || seen == last) continue;
        last = seen;
        float distance = hit_distance(pixel, int(seen.x) - 1, int(seen.y));
        if (distance < least) {
            least = distance;
            nearest = seen;
        }
    }
}
