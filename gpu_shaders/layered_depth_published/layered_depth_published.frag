// Reflections by layered depth textures as Zhang et al. publish them (3.2 to 3.4), blended over the
// global environment map.

#include "common/reflection.glsl"
#include "common/environment.glsl"
#include "layered_depth_published/search.glsl"
#include "regions/mask.glsl"

uniform int objects;       // instances of the scene
uniform bool use_regions;
uniform bool nearest;      // of several objects, the nearest; else the last, as blending leaves it

Mirrored mirrored_light(Surface s, Hit from, Ray ray) {
    Ray reflected = Ray(s.position, reflect(ray.direction, s.normal));
    Mirrored seen = Mirrored(environment_radiance(reflector_of(from.instance), reflected.direction), FAR);
    for (int object = 0; object < objects; ++object) {
        bool baked = texelFetch(peeled_objects, texel_at(4 * object), 0).x != 0u;
        if (!baked || object == from.instance || (use_regions && !in_region(from, object))) continue;
        Found found = search_object(object, reflected);
        if (found.distance < (nearest ? seen.distance : FAR)) seen = Mirrored(found.radiance, found.distance);
    }
    seen.radiance *= reflectance(s, ray.direction);
    return seen;
}
