// Reflections by rays: the nearest hit over all objects, the reflector itself included, followed from mirror to mirror.
// TRACER (common/tracer.glsl) says what is searched.

#include "traced/mirrors.glsl"

bool is_shown(Surface s) {
    return true;
}
