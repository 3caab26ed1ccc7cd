// The nearest triangle along a ray, by trees of the meshes' triangles (addon/tracing/trees.py).

#include "common/instances.glsl"

// The root of each mesh, 1 texel; then 4 texels a node: boxes of four children along x, y and z, the low side in
// the lower half of a word and the high side in the upper, in units of the mesh's box | children.
uniform usampler2D tree_nodes;

const float STEPS = 65535.0;
const int DEPTH = 32;
const int END = -0x7fffffff - 1;
const float NEVER = 3e38;

// Narrows what a ray reaches of four boxes, from `near` to `far` counted from the mesh's box on, to what lies between
// their sides across an axis. Of the box of no child, whose sides are exchanged, nothing is left.
void keep_between(uvec4 sides, float origin, float inverse, inout vec4 near, inout vec4 far) {
    if (inverse < 0.0) sides = sides >> 16 | sides << 16;
    near = max(near, (vec4(sides & 0xffffu) - origin) * inverse);
    far = min(far, (vec4(sides >> 16) - origin) * inverse);
}

void put_in_order(inout float a, inout float b, inout int first, inout int second) {
    bool swap = b < a;
    float t = a;
    int c = first;
    a = swap ? b : a;
    b = swap ? t : b;
    first = swap ? second : first;
    second = swap ? c : second;
}

// The tree's children, whether nodes or triangles, that are met within `reach`: `at` NEVER for the others.
ivec4 children_of(int node, vec3 origin, vec3 inverse, float reach, out vec4 at) {
    vec4 near = vec4(0.0), far = vec4(reach);
    keep_between(texelFetch(tree_nodes, texel_at(4 * node), 0), origin.x, inverse.x, near, far);
    keep_between(texelFetch(tree_nodes, texel_at(4 * node + 1), 0), origin.y, inverse.y, near, far);
    keep_between(texelFetch(tree_nodes, texel_at(4 * node + 2), 0), origin.z, inverse.z, near, far);
    ivec4 children = ivec4(texelFetch(tree_nodes, texel_at(4 * node + 3), 0));
    at = mix(vec4(NEVER), near, lessThanEqual(near, far));
    put_in_order(at.x, at.y, children.x, children.y);
    put_in_order(at.z, at.w, children.z, children.w);
    put_in_order(at.x, at.z, children.x, children.z);
    put_in_order(at.y, at.w, children.y, children.w);
    put_in_order(at.y, at.z, children.y, children.z);
    return children;
}

// Walks a tree from its root, the nearest child first. `ray` counts distance from the box on; `origin` and `inverse`
// (of its direction) are the same ray in units of the box.
void walk_tree(int root, vec3 origin, vec3 inverse, Segment ray, float least, int instance, Hit from, inout Hit hit) {
    int later[3 * DEPTH];
    int count = 0, place = root;
    do {
        do {
            vec4 at;
            ivec4 children = children_of(place, origin, inverse, min(ray.end, hit.distance - ray.start), at);
            if (at.w < NEVER) later[count++] = children.w;
            if (at.z < NEVER) later[count++] = children.z;
            if (at.y < NEVER) later[count++] = children.y;
            place = at.x < NEVER ? children.x : count > 0 ? later[--count] : END;
        } while (place >= 0);
        while (place < 0 && place != END) {
            meet_triangle(-1 - place, ray, least, instance, from, hit);
            place = count > 0 ? later[--count] : END;
        }
    } while (place != END);
}

void meet_instance(Ray world, int instance, float least, Hit from, inout Hit hit) {
    vec3 low = instance_texel(instance, 7).xyz, size = instance_texel(instance, 8).xyz;
    Segment ray = segment_within(world, instance, low, size, hit.distance);
    if (ray.end <= 0.0) return;
    int root = int(texelFetch(tree_nodes, texel_at(mesh_of(instance)), 0).x);
    vec3 scale = STEPS / size;
    walk_tree(root, (ray.origin - low) * scale, safe_inverse(ray.direction * scale), ray, least, instance, from, hit);
}
