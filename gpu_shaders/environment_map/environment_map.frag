// Environment mapping (Blinn and Newell 1976): the cube is looked up by direction alone, as if all lay
// infinitely far away.

#include "common/reflection.glsl"
#include "common/environment.glsl"

Mirrored mirrored_light(Surface s, vec3 direction) {
    vec3 towards = mirrored_ray(s, direction).direction;
    return Mirrored(reflectance(s, direction) * environment_radiance(reflector_of(s.at.instance), towards), FAR);
}
