// What a mirror shows that may be rough: as much as its rays bring. A shader that includes this says which surfaces it
// shows, how they mirror without roughness, and what one ray brings.
//
// With SHARED, a number of pixels, only one ray is sent for each pixel and kept apart; the pixels of a square with that
// side then look along the rays of each other (rough/shared.frag), and what steps that leaves is evened (even.frag).
// With a STRIDE of 2 only one pixel of every four sends a ray; the shader then says which pixels may.

#include "common/reflection.glsl"
#include "common/lobe.glsl"

#ifndef ROUGH
#define ROUGH 0  // whether any mirror is rough
#endif

uniform int rays;      // of each sample of a pixel
uniform int all_rays;  // of all its samples

bool is_shown(Surface s);
Mirrored sharp_light(Surface s, vec3 direction);
// What arrives along the ray of a facet; `number` is its own among the `count` rays that share out the lobe.
Mirrored light_along(Surface s, Lobe lobe, Facet facet, int number, int count);

Mirrored rough_light(Surface s, vec3 direction) {
    Lobe lobe = lobe_of(s, direction);
    vec3 sum = vec3(0.0), covered = vec3(0.0);
    float nearest = FAR;
    for (int i = 0; i < rays; ++i) {
        Facet facet = facet_of(lobe, s, random(first_ray + i));
        covered += facet.covered;
        if (facet.kept == vec3(0.0)) continue;
        Mirrored there = light_along(s, lobe, facet, first_ray + i, all_rays);
        sum += facet.kept * there.radiance;
        if (i == 0) nearest = there.distance;
    }
    return Mirrored(sum / float(rays) + uncovered(s, direction, covered / float(rays)), nearest);
}

#if SHARED == 0

Mirrored mirrored_light(Surface s, vec3 direction) {
    if (!is_shown(s)) discard;
#if ROUGH
    if (alpha_of(s) >= SHARP) return rough_light(s, direction);
#endif
    return sharp_light(s, direction);
}

#else

#include "rough/squares.glsl"

layout(location = 0) out vec4 arrived;  // radiance along the pixel's ray; its density, 0 without a ray, or ALONE
layout(location = 1) out vec4 end;      // of the ray, in the world, or how far away that is; metres from the viewer

const float ALONE = -1.0;        // the pixel's light is all its own, and whole
const float NARROW = 2.0;        // alpha of a lobe that tells pixels apart, over the diagonal of a pixel
const float NO_END = 1e7;        // metres: where a ray ends that meets nothing
const float NEAREST_END = 1e-3;  // of the way from the viewer: what rounding leaves of a direction

// Whether what the neighbours mirror is not what this pixel does.
bool is_narrow(Surface s, vec3 direction) {
    vec3 beside = camera_ray((vec2(own_pixel()) + 1.5) / vec2(textureSize(visibility, 0))).direction;
    vec3 turns = fwidth(s.normal);
    return alpha_of(s) * -dot(direction, s.normal) < NARROW * distance(beside, direction) + length(turns);
}

#if STRIDE > 1

bool may_send(uvec2 seen);  // what the visibility pass found at a pixel

ivec2 own_pixel() {
    ivec2 square = STRIDE * ivec2(gl_FragCoord.xy), last = textureSize(visibility, 0) - 1;
    for (int i = 0; i < STRIDE * STRIDE; ++i) {
        ivec2 pixel = min(square + first_in_square(first_ray / rays + i), last);
        if (may_send(texelFetch(visibility, pixel, 0).xy)) return pixel;
    }
    return square;
}

#endif

void show(Surface s, Ray ray) {
#if STRIDE == 1
    bool narrow = is_narrow(s, ray.direction);
#else
    const bool narrow = false;
#endif
    if (!is_shown(s)) discard;
    float away = distance(s.position, ray.origin);
    if (narrow || alpha_of(s) < SHARP) {
        Mirrored there;
        if (alpha_of(s) < SHARP) there = sharp_light(s, ray.direction);
        else there = rough_light(s, ray.direction);
        arrived = vec4(there.radiance, ALONE);
        end = vec4(there.distance, 0.0, 0.0, away);
        return;
    }
    Lobe lobe = lobe_of(s, ray.direction);
    Facet facet = facet_of(lobe, s, shared_random(SHARED, first_ray / rays));
    Mirrored there = Mirrored(vec3(0.0), FAR);
    if (facet.kept != vec3(0.0)) there = light_along(s, lobe, facet, 0, SHARED * SHARED * all_rays / rays);
    arrived = vec4(there.radiance, facet.density);
    vec3 met = s.position + clamp(there.distance, NEAREST_END * away, NO_END) * facet.direction;
    end = vec4(met, marked(away, own_pixel() - STRIDE * ivec2(gl_FragCoord.xy)));
}

#endif
