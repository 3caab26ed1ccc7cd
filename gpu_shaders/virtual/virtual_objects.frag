// Reflections by virtual objects (after Estalella et al.): the triangle that the mirrored ray meets was found by
// drawing every triangle where its vertices are reflected. What was not searched, and what is mirrored more often, is
// left to REST: 0 environment maps, 1 layered depth textures.

#include "common/reflection.glsl"
#include "virtual/seen.glsl"
#if REST == 0
#include "environment_map/box.glsl"
#include "virtual/parts.glsl"
#else
#include "common/traced.glsl"
#endif

uniform usampler2D virtual_objects;        // what the mirrored rays meet
uniform usampler2D virtual_objects_again;  // and those that are mirrored once more
uniform int orders;                        // how many of these there are
uniform int allowed;                       // how often light may be mirrored before it goes black

Mirrored rest(Surface s, vec3 direction, int mirrored) {
    if (mirrored >= allowed) return Mirrored(vec3(0.0), FAR);
#if REST == 0
    Ray ray = mirrored_ray(s, direction);
    return Mirrored(reflectance(s, direction) * boxed_radiance(ordinal_of(s.at.instance), ray), FAR);
#else
    return traced_light(s, direction, allowed - mirrored);
#endif
}

Hit hit_on(uvec2 seen, Ray ray) {
    if (seen.x == WORLD_SEEN) return Hit(NONE, NONE, vec2(0.0), FAR);
    int instance = int(seen.x) - 1;
    vec3 met = meet_plane_of(instance, int(seen.y), ray);
    return Hit(instance, int(seen.y), met.xy, met.z);
}

Mirrored mirrored_light(Surface s, vec3 direction) {
    Mirrored sum = Mirrored(vec3(0.0), FAR);
    vec3 passed = vec3(1.0);
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    int mirrored = 0;
    bool goes_on = true;
    while (goes_on && mirrored < orders) {
        uvec2 seen = mirrored == 0 ? texelFetch(virtual_objects, pixel, 0).xy
                                   : texelFetch(virtual_objects_again, pixel, 0).xy;
        if (seen.x == NOT_SEARCHED) break;
        passed *= reflectance(s, direction);
        Ray ray = mirrored_ray(s, direction);
        direction = ray.direction;
        Hit hit = hit_on(seen, ray);
        if (mirrored++ == 0) sum.distance = hit.distance;
        goes_on = hit.instance != NONE;
        if (goes_on) {
            s = surface_at(hit, direction);
            sum.radiance += passed * own_radiance(s, direction);
            goes_on = s.reflects;
        } else {
            sum.radiance += passed * world_radiance(direction);
        }
    }
    if (!goes_on) return sum;
    Mirrored left = rest(s, direction, mirrored);
    return Mirrored(sum.radiance + passed * left.radiance, mirrored == 0 ? left.distance : sum.distance);
}
