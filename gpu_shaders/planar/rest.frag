// The triangles of a planar reflector that lie in no flat part, a bevelled edge for one.

#include "common/reflection.glsl"
#include "common/traced.glsl"
#include "planar/mirror.glsl"

uniform int reflections;  // how often a path may reflect before it goes black

Mirrored mirrored_light(Surface s, vec3 direction) {
    if (!shows_mirror(s.at.instance, s.at.triangle)) discard;
    return traced_light(s, direction, reflections);
}
