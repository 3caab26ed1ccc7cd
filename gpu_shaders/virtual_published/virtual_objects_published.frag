// Reflections by virtual objects as published (Estalella et al.): the virtual meshes are blended over the environment
// map, which holds what has none.

#include "common/reflection.glsl"
#include "common/environment.glsl"

uniform usampler2D virtual_objects;  // instance + 1, triangle, barycentrics

Mirrored mirrored_light(Surface s, vec3 direction) {
    vec3 passed = reflectance(s, direction);
    uvec4 seen = texelFetch(virtual_objects, ivec2(gl_FragCoord.xy), 0);
    if (seen.x == 0u) {
        vec3 towards = mirrored_ray(s, direction).direction;
        return Mirrored(passed * environment_radiance(reflector_of(s.at.instance), towards), FAR);
    }
    Hit hit = Hit(int(seen.x) - 1, int(seen.y), uintBitsToFloat(seen.zw), 0.0);
    vec3 way = surface_at(hit, direction).position - s.position;
    return Mirrored(passed * own_radiance(surface_at(hit, normalize(way)), normalize(way)), length(way));
}
