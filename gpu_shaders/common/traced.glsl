// Reflections by rays that go from mirror to mirror, whatever tracer finds what they meet.

#include "common/mirrored.glsl"
#include "common/tracer.glsl"
#include "common/lobe.glsl"

#ifndef ROUGH
#define ROUGH 0  // a program that does not say takes every mirror for a perfect one
#endif

// Turns `ray` at a mirror that it has met for the `turn`th time. `through` is what is left of its light, `number` its
// own among all rays of a pixel. Gives what it uncovers of what lies under a rough mirror.
vec3 turned(Surface mirror, int number, int turn, inout Ray ray, inout vec3 through) {
#if ROUGH
    if (alpha_of(mirror) >= SHARP) {
        Facet facet = facet_of(lobe_of(mirror, ray.direction), mirror, random(number, turn));
        vec3 own = through * uncovered(mirror, ray.direction, facet.covered);
        through *= facet.kept;
        ray = Ray(mirror.position, facet.direction);
        return own;
    }
#endif
    through *= reflectance(mirror, ray.direction);
    ray = mirrored_ray(mirror, ray.direction);
    return vec3(0.0);
}

// What arrives along a ray that a mirror at `at` has sent, times `through`. It may be turned `turns` times more before
// it goes black.
Mirrored arriving(Ray ray, Hit at, vec3 through, int turns, int number) {
    Mirrored seen = Mirrored(vec3(0.0), FAR);
    bool goes_on;
    int turn = 0;
    do {
        // Looked up anew, so that a surface which ends the path is not asked for its normal.
        if (turn > 0) seen.radiance += turned(surface_at(at, ray.direction), number, turn, ray, through);
        at = nearest_hit(ray, at, FAR);
        if (turn == 0) seen.distance = at.distance;
        goes_on = at.instance != NONE;
        if (goes_on) {
            Surface met = surface_at(at, ray.direction);
            seen.radiance += through * own_radiance(met, ray.direction);
            goes_on = met.reflects;
        } else {
            seen.radiance += through * world_radiance(ray.direction);
        }
    } while (goes_on && ++turn <= turns);
    return seen;
}

// `reflections`: how often a path may reflect before it goes black, this time included; here it does so sharply.
Mirrored traced_light(Surface s, vec3 direction, int reflections) {
    return arriving(mirrored_ray(s, direction), s.at, reflectance(s, direction), reflections - 1, first_ray);
}
