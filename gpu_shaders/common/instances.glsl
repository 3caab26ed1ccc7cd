// Which instances a ray may meet, front to back: a walk over a hierarchy of their boxes
// (addon/tracing/hierarchy.py).
//
// Lanes walk in step, and one without work waits (or, in llvmpipe, works in vain) while another has some. So
// each loop looks for the next thing to do with as little as possible, does it outside of that search, and
// asks at its end whether there is more (Aila and Laine 2009).

#include "common/scene.glsl"

// The hierarchy, once for each octant of directions, 2 texels a node: low, next on a miss | high, instance or NONE.
uniform int first_node;
uniform int hierarchy_nodes;

// The part of a ray within a box: from `start` metres along the ray, `end` metres long.
struct Segment {
    vec3 origin, direction;
    float start, end;
};

vec2 box_span(vec3 origin, vec3 inverse, vec3 low, vec3 high) {
    vec3 a = (low - origin) * inverse, b = (high - origin) * inverse;
    vec3 near = min(a, b), far = max(a, b);
    return vec2(max(max(near.x, near.y), near.z), min(min(far.x, far.y), far.z));
}

vec3 safe_inverse(vec3 v) {
    vec3 tiny = vec3(1e-30);
    return 1.0 / mix(v, mix(tiny, -tiny, lessThan(v, vec3(0.0))), lessThan(abs(v), tiny));
}

// What is left within `reach` of a ray in an instance's box, in the space of its mesh; nothing has no length.
Segment segment_within(Ray world, int instance, vec3 low, vec3 size, float reach) {
    mat4x3 inward = world_to_object(instance);
    vec3 origin = inward * vec4(world.origin, 1.0), direction = mat3(inward) * world.direction;
    vec2 span = box_span(origin, safe_inverse(direction), low, low + size);
    span = vec2(max(span.x, 0.0), min(span.y, reach));
    return Segment(origin + span.x * direction, direction, span.x, span.y - span.x);
}

// Tests a triangle against the ray, given in the mesh's space from its box on.
void meet_triangle(int triangle, Segment ray, float least, int instance, Hit from, inout Hit hit) {
    vec3 met = meet_plane(ray.origin, ray.direction, triangle_at(triangle));
    float distance = ray.start + met.z;
    bool inside = met.x >= -1e-6 && met.y >= -1e-6 && met.x + met.y <= 1.000001;
    if (inside && distance > least && distance < hit.distance
        && !(instance == from.instance && triangle == from.triangle))
        hit = Hit(instance, triangle, met.xy, distance);
}

// The instance whose outside `ray` leaves for good, because its mesh is convex; NONE if there is none.
int left_behind(Ray ray, Hit from) {
    if (from.instance == NONE || instance_texel(from.instance, 8).w == 0.0) return NONE;
    Triangle t = triangle_at(from.triangle);
    vec3 direction = mat3(world_to_object(from.instance)) * ray.direction;
    return dot(cross(t.b - t.a, t.c - t.a), direction) > 0.0 ? from.instance : NONE;
}

// The next instance whose box `ray` meets before `reach`, NONE if there is none; `node` is where to look on.
int next_instance(inout int node, int first, Ray ray, vec3 inverse, float reach, int skipped) {
    int found = NONE;
    do {
        vec4 low = texelFetch(records, texel_at(first + 2 * node), 0);
        vec4 high = texelFetch(records, texel_at(first + 2 * node + 1), 0);
        vec2 span = box_span(ray.origin, inverse, low.xyz, high.xyz);
        bool missed = span.x > span.y || span.y < 0.0 || span.x > reach;
        node = missed ? int(low.w) : node + 1;
        if (!missed && int(high.w) != skipped) found = int(high.w);
    } while (found < 0 && node < hierarchy_nodes);
    return found;
}
