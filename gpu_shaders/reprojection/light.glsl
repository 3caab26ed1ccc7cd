// What mirrored rays bring back, hit by hit, so that a hit that is known already need not be searched.

#include "common/picture.glsl"
#include "common/traced.glsl"

uniform int reflections;  // how often a path may reflect before it goes black

// The radiance that `at` sends back along `direction`; from there on a path may still reflect `left` times.
vec3 light_at(Hit at, vec3 direction, int left) {
    if (at.instance == NONE) return world_radiance(direction);
    Surface met = surface_at(at, direction);
    vec3 light = own_radiance(met, direction);
    if (met.reflects && left > 0) light += traced_light(met, direction, left).radiance;
    return light;
}

// What a mirrored ray met, and what its own mirrored ray did, where it was mirrored once more.
struct Path {
    Hit first, second;
    bool goes_on;
    vec3 light;  // radiance that arrives at the reflector
};

Path traced_path(Surface s, vec3 direction) {
    Ray ray = mirrored_ray(s, direction);
    Hit nothing = Hit(NONE, NONE, vec2(0.0), FAR);
    Path path = Path(nearest_hit(ray, s.at, FAR), nothing, false, vec3(0.0));
    if (path.first.instance == NONE) {
        path.light = world_radiance(ray.direction);
        return path;
    }
    Surface met = surface_at(path.first, ray.direction);
    path.light = own_radiance(met, ray.direction);
    path.goes_on = met.reflects && reflections > 1;
    if (path.goes_on) {
        Ray again = mirrored_ray(met, ray.direction);
        path.second = nearest_hit(again, path.first, FAR);
        path.light += reflectance(met, ray.direction) * light_at(path.second, again.direction, reflections - 2);
    }
    return path;
}
