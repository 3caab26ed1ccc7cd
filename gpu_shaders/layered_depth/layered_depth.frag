// Reflections by a search of layered depth textures whose texels hold triangles: the nearest hit over
// all objects, the reflector itself included, followed from mirror to mirror.

#include "common/reflection.glsl"
#include "common/traced.glsl"

uniform int reflections;  // how often a path may reflect before it goes black

Mirrored mirrored_light(Surface s, vec3 direction) {
    return traced_light(s, direction, reflections);
}
