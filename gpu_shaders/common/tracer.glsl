// The nearest triangle along a ray. TRACER chooses what is searched of each instance that the ray may meet:
// 0 layered depth textures, 1 trees. A program that does not say takes the first.

#include "common/instances.glsl"

#ifndef TRACER
#define TRACER 0
#endif

#if TRACER == 0
#include "common/layers.glsl"
#else
#include "common/trees.glsl"
#endif

// The nearest hit of `ray` within `reach` metres; `from` is the point it leaves, never met again.
Hit nearest_hit(Ray ray, Hit from, float reach) {
    Hit hit = Hit(NONE, NONE, vec2(0.0), reach);
    vec3 inverse = safe_inverse(ray.direction);
    float least = 1e-5 * (1.0 + length(ray.origin));
    int skipped = left_behind(ray, from);
    ivec3 down = ivec3(lessThan(ray.direction, vec3(0.0)));
    int first = first_node + 2 * hierarchy_nodes * (down.x + 2 * down.y + 4 * down.z);
    int node = 0;
    int instance = next_instance(node, first, ray, inverse, reach, skipped);
    if (instance >= 0) do {
        meet_instance(ray, instance, least, from, hit);
        instance = NONE;
        if (node < hierarchy_nodes) instance = next_instance(node, first, ray, inverse, hit.distance, skipped);
    } while (instance >= 0);
    return hit;
}
