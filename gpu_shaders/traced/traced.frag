// Reflections by rays: the nearest hit over all objects, the reflector itself included, followed from mirror to mirror.
// TRACER (common/tracer.glsl) says what is searched.

#include "common/reflection.glsl"
#include "common/traced.glsl"

uniform int reflections;  // how often a path may reflect before it goes black

Mirrored mirrored_light(Surface s, vec3 direction) {
    return traced_light(s, direction, reflections);
}
