// Reflections by rays that go from mirror to mirror, whatever tracer finds what they meet.

#include "common/mirrored.glsl"
#include "common/tracer.glsl"

// `reflections`: how often a path may reflect before it goes black, this time included.
Mirrored traced_light(Surface s, vec3 direction, int reflections) {
    Mirrored seen = Mirrored(vec3(0.0), FAR);
    vec3 throughput = vec3(1.0);
    Hit at = s.at;
    bool goes_on;
    int i = 0;
    do {
        // Looked up anew, so that a surface which ends the path is not asked for its normal.
        Surface mirror = surface_at(at, direction);
        throughput *= reflectance(mirror, direction);
        Ray ray = mirrored_ray(mirror, direction);
        direction = ray.direction;
        at = nearest_hit(ray, at, FAR);
        if (i == 0) seen.distance = at.distance;
        goes_on = at.instance != NONE;
        if (goes_on) {
            Surface met = surface_at(at, direction);
            seen.radiance += throughput * own_radiance(met, direction);
            goes_on = met.reflects;
        } else {
            seen.radiance += throughput * world_radiance(direction);
        }
    } while (goes_on && ++i < reflections);
    return seen;
}
