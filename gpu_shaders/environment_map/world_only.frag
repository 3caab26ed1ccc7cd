// Reflectors within a captured cube: they mirror the world behind everything, no more.

#include "common/reflection.glsl"

Mirrored mirrored_light(Surface s, Hit from, Ray ray) {
    return Mirrored(reflectance(s, ray.direction) * world_radiance(reflect(ray.direction, s.normal)), FAR);
}
