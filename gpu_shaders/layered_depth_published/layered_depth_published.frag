// Reflections by layered depth textures as Zhang et al. publish them (3.2 to 3.4), blended over the
// global environment map.

#include "common/reflection.glsl"
#include "common/environment.glsl"
#include "layered_depth_published/search.glsl"
#include "regions/mask.glsl"

uniform int objects;       // instances of the scene
uniform bool use_regions;
uniform bool nearest;      // of several objects, the nearest; else the last, as blending leaves it

// The next object after `object` that the point may show, `objects` if there is none.
int next_object(int object, Hit from) {
    bool shown = false;
    while (!shown && ++object < objects) {
        bool baked = texelFetch(peeled_objects, texel_at(4 * object), 0).x != 0u;
        shown = baked && object != from.instance && (!use_regions || in_region(from, object));
    }
    return object;
}

Mirrored mirrored_light(Surface s, vec3 direction) {
    Ray reflected = mirrored_ray(s, direction);
    Mirrored seen = Mirrored(environment_radiance(reflector_of(s.at.instance), reflected.direction), FAR);
    int object = next_object(-1, s.at);
    if (object < objects) do {
        Found found = search_object(object, reflected);
        if (found.distance < (nearest ? seen.distance : FAR)) seen = Mirrored(found.radiance, found.distance);
        object = next_object(object, s.at);
    } while (object < objects);
    seen.radiance *= reflectance(s, direction);
    return seen;
}
