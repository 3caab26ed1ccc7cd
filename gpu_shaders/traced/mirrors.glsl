// Mirrors, sharp or rough, by rays that are traced.

#include "common/rough.glsl"
#include "common/traced.glsl"

uniform int reflections;  // how often a path may reflect before it goes black

Mirrored sharp_light(Surface s, vec3 direction) {
    return traced_light(s, direction, reflections);
}

Mirrored light_along(Surface s, Lobe lobe, Facet facet, int number, int count) {
    return arriving(Ray(s.position, facet.direction), s.at, vec3(1.0), reflections - 1, number);
}
