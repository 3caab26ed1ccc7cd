// Reflectors within a captured cube: they mirror the world behind everything, no more.

#include "common/reflection.glsl"

Mirrored mirrored_light(Surface s, vec3 direction) {
    return Mirrored(reflectance(s, direction) * world_radiance(mirrored_ray(s, direction).direction), FAR);
}
