// Reflections by a search of layered depth textures whose texels hold triangles: the nearest hit over
// all objects, the reflector itself included, followed from mirror to mirror.

#include "common/reflection.glsl"
#include "common/layers.glsl"

uniform int reflections;  // how often a path may reflect before it goes black

Mirrored mirrored_light(Surface s, Hit from, Ray ray) {
    Mirrored seen = Mirrored(vec3(0.0), FAR);
    vec3 throughput = vec3(1.0);
    vec3 mirrored = reflectance(s, ray.direction);
    for (int i = 0; i < reflections && s.reflects; ++i) {
        throughput *= mirrored;
        ray = Ray(s.position, reflect(ray.direction, s.normal));
        from = nearest_hit(ray, from, FAR);
        if (i == 0) seen.distance = from.distance;
        if (from.instance == NONE) {
            seen.radiance += throughput * world_radiance(ray.direction);
            break;
        }
        s = surface_at(from, ray.direction);
        mirrored = reflectance(s, ray.direction);
        seen.radiance += throughput * own_radiance(s, mirrored);
    }
    return seen;
}
