// Environment mapping (Blinn and Newell 1976): the cube is looked up by direction alone, as if all lay
// infinitely far away.

#include "common/reflection.glsl"
#include "common/environment.glsl"

Mirrored mirrored_light(Surface s, Hit from, Ray ray) {
    vec3 direction = reflect(ray.direction, s.normal);
    return Mirrored(reflectance(s, ray.direction) * environment_radiance(reflector_of(from.instance), direction), FAR);
}
