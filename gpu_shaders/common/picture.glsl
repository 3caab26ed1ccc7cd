// What a full-screen pass knows of its pixel: the ray through it and the triangle that the
// visibility pass found there.

#include "common/camera.glsl"
#include "common/lighting.glsl"

uniform usampler2D visibility;
uniform ivec2 corner;  // where the picture begins in its target, in pixels

const float FAR = 1e30;

#ifndef STRIDE
#define STRIDE 1  // a pass draws one pixel of each square of so many by so many, on a target as much smaller
#endif

#if STRIDE == 1
ivec2 own_pixel() {
    return ivec2(gl_FragCoord.xy) - corner;
}
#else
ivec2 own_pixel();  // of its square
#endif

Ray pixel_ray(ivec2 pixel) {
    return camera_ray((vec2(pixel) + 0.5) / vec2(textureSize(visibility, 0)));
}

Ray pixel_ray() {
    return pixel_ray(own_pixel());
}

// `instance` is NONE where the pixel shows the world.
Hit pixel_hit(Ray ray, ivec2 pixel) {
    uvec2 seen = texelFetch(visibility, pixel, 0).xy;
    if (seen.x == 0u) return Hit(NONE, NONE, vec2(0.0), FAR);
    int instance = int(seen.x) - 1, triangle = int(seen.y);
    vec3 met = meet_plane_of(instance, triangle, ray);
    // A pixel that the rasteriser gave to a triangle may lie a rounding outside it.
    return Hit(instance, triangle, clamp(met.xy, 0.0, 1.0), met.z);
}

Hit pixel_hit(Ray ray) {
    return pixel_hit(ray, own_pixel());
}
