// The nearest triangle along a ray, by layered depth textures whose texels hold triangles
// (addon/tracing/layers.py): a walk over columns cut into slices of depth.
// Loops look first and work after, as in common/instances.glsl.

#include "common/instances.glsl"

uniform usampler2D layer_nodes;   // 2 texels a mesh: see grid_of; 1 a block of columns: slices (2 words), first span
uniform usampler2D layer_spans;   // 1 texel an occupied slice: first entry, how many
uniform usampler2D layer_entries; // 1 texel an entry: triangle

const int SLICES = 64;
const float NUDGE = 2e-3;  // columns: past a border, less than triangles are widened

uint bits_between(int first, int last) {
    first = max(first, 0);
    last = min(last, 31);
    return first > last ? 0u : (0xffffffffu >> (31 - last + first)) << first;
}

// First and last slice that a ray passes between two depths.
ivec2 slices_between(vec2 depth) {
    return clamp(ivec2(floor(vec2(min(depth.x, depth.y) - 1e-3, max(depth.x, depth.y) + 1e-3))), 0, SLICES - 1);
}

uvec2 words_of(ivec2 slices) {
    return uvec2(bits_between(slices.x, slices.y), bits_between(slices.x - 32, slices.y - 32));
}

// Tests the triangles of a slice against the ray, given in the mesh's space from its box on.
void meet_span(uvec2 span, Segment ray, float least, int instance, Hit from, inout Hit hit) {
    uint entry = span.x;
    do {
        int triangle = int(texelFetch(layer_entries, texel_at(int(entry)), 0).x);
        meet_triangle(triangle, ray, least, instance, from, hit);
    } while (++entry < span.x + span.y);
}

// Tests the slices of a column that are both `wanted` and occupied, in the order of the ray, which enters it at `at`.
// A slice may list a triangle that is met far behind it: the slices before that are tested as well.
void meet_column(uvec3 column, uvec2 wanted, Segment local, float at, Segment ray, float least,
                 int instance, Hit from, inout Hit hit) {
    bool upwards = local.direction.z >= 0.0;
    do {
        bool low = upwards ? wanted.x != 0u : wanted.y == 0u;
        uint word = low ? wanted.x : wanted.y;
        int bit = upwards ? findLSB(word) : findMSB(word);
        uint below = (low ? column.x : column.y) & ((1u << bit) - 1u);
        int span = int(column.z) + bitCount(below) + (low ? 0 : bitCount(column.x));
        meet_span(texelFetch(layer_spans, texel_at(span), 0).xy, ray, least, instance, from, hit);
        wanted &= ~(low ? uvec2(1u << bit, 0u) : uvec2(0u, 1u << bit));
        float until = min(hit.distance - ray.start, local.end);
        wanted &= words_of(slices_between(local.origin.z + vec2(at, until) * local.direction.z));
    } while (wanted != uvec2(0u));
}

int blocks_at(ivec2 shape, int level) {
    ivec2 blocks = (shape + (1 << level) - 1) >> level;
    return blocks.x * blocks.y;
}

// A place on a walk over the columns of a mesh: a block of them at a level of the pyramid.
struct Walk {
    float at, next;   // metres from the box on: where the ray enters the block, and where it leaves it
    ivec2 block;
    int level, first_block;
};

// The slices of the block that the ray passes and that hold anything; `node` is the block's.
uvec2 look(inout Walk walk, ivec2 shape, Segment local, vec2 inverse, vec2 nudge, vec2 forward, out uvec3 node) {
    vec2 place = clamp(local.origin.xy + walk.at * local.direction.xy + nudge, vec2(0.0), vec2(shape) - 0.5);
    walk.block = ivec2(place) >> walk.level;
    vec2 leaves = ((vec2(walk.block) + forward) * float(1 << walk.level) - local.origin.xy) * inverse;
    walk.next = max(min(min(leaves.x, leaves.y), local.end), walk.at);
    int row = (shape.x + (1 << walk.level) - 1) >> walk.level;
    node = texelFetch(layer_nodes, texel_at(walk.first_block + walk.block.x + row * walk.block.y), 0).xyz;
    return node.xy & words_of(slices_between(local.origin.z + vec2(walk.at, walk.next) * local.direction.z));
}

void go_on(inout Walk walk, ivec2 shape, int top, Segment local, vec2 nudge) {
    ivec2 after = ivec2(local.origin.xy + walk.next * local.direction.xy + nudge) >> walk.level;
    if (walk.level < top && after >> 1 != walk.block >> 1) walk.first_block += blocks_at(shape, walk.level++);
    // A block that ends where the ray enters it is the last one, clamped: the ray has left the grid.
    walk.at = walk.next > walk.at ? walk.next + 1e-6 * walk.next : local.end;
}

// Walks the columns of a mesh from the coarsest level. `local` is the ray with u and v in columns and
// depth in slices; both count distance from the box on.
void walk_columns(ivec4 grid, Segment local, Segment ray, float least, int instance, Hit from, inout Hit hit) {
    ivec2 shape = grid.xy;
    int top = grid.z - 1;
    vec2 inverse = safe_inverse(local.direction).xy;
    vec2 forward = vec2(greaterThanEqual(local.direction.xy, vec2(0.0)));
    vec2 nudge = NUDGE * sign(local.direction.xy);
    Walk walk = Walk(0.0, 0.0, ivec2(0), top, grid.w);
    uvec3 node;
    uvec2 wanted;
    do {
        bool found = false;
        do {
            wanted = look(walk, shape, local, inverse, nudge, forward, node);
            if (wanted == uvec2(0u)) go_on(walk, shape, top, local, nudge);
            else if (walk.level > 0) walk.first_block -= blocks_at(shape, --walk.level);
            else found = true;
        } while (!found && walk.at < local.end);
        if (found) {
            meet_column(node, wanted, local, walk.at, ray, least, instance, from, hit);
            go_on(walk, shape, top, local, nudge);
        }
    } while (walk.at < local.end && ray.start + walk.at < hit.distance);
}

// Columns along u and v, levels, and the coarsest node.
ivec4 grid_of(int instance) {
    int head = 2 * mesh_of(instance);
    return ivec4(texelFetch(layer_nodes, texel_at(head), 0).xyz, texelFetch(layer_nodes, texel_at(head + 1), 0).x);
}

void meet_instance(Ray world, int instance, float least, Hit from, inout Hit hit) {
    vec4 low = instance_texel(instance, 7), size = instance_texel(instance, 8);
    Segment ray = segment_within(world, instance, low.xyz, size.xyz, hit.distance);
    if (ray.end <= 0.0) return;
    vec3 scale = 1.0 / size.xyz, o = (ray.origin - low.xyz) * scale, d = ray.direction * scale;
    o = low.w == 0.0 ? o.yzx : low.w == 1.0 ? o.zxy : o;
    d = low.w == 0.0 ? d.yzx : low.w == 1.0 ? d.zxy : d;
    ivec4 grid = grid_of(instance);
    vec3 cells = vec3(grid.xy, SLICES);
    Segment local = Segment(cells * o, cells * d, 0.0, ray.end);
    walk_columns(grid, local, ray, least, instance, from, hit);
}
