// Box-projected environment mapping (Lagarde and Zanuttini 2012): the ray goes on to a box around the
// scene, and the cube is looked up towards the point it meets there.

#include "common/reflection.glsl"
#include "common/environment.glsl"

Mirrored mirrored_light(Surface s, vec3 direction) {
    int reflector = reflector_of(s.at.instance);
    vec3 mirrored = mirrored_ray(s, direction).direction;
    vec3 ahead = mix(capture_texel(reflector, 1), capture_texel(reflector, 2), greaterThan(mirrored, vec3(0.0)));
    vec3 reach = (ahead - s.position) / mix(mirrored, vec3(1e-20), equal(mirrored, vec3(0.0)));
    float distance = max(0.0, min(min(reach.x, reach.y), reach.z));
    vec3 towards = s.position + distance * mirrored - capture_texel(reflector, 0);
    return Mirrored(reflectance(s, direction) * environment_radiance(reflector, towards), distance);
}
