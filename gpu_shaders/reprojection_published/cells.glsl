// The two triangles of a cell. A geometry shader includes this and defines the corners.

#include "reprojection_published/known.glsl"

layout(points) in;
layout(triangle_strip, max_vertices = 6) out;

flat in ivec2 cell[];

// Its corners are those of a Z, the triangles (0, 1, 2) and (3, 2, 1) of them.
ivec2 pixel_of(int corner) {
    return cell[0] + ivec2(corner & 1, corner >> 1);
}

// Whether two triangles of mirrors' pixels may be drawn: not across a depth discontinuity.
bvec2 are_whole() {
    vec4 depth;
    bvec4 mirrors;
    for (int i = 0; i < 4; ++i) {
        vec4 texel = texelFetch(known_geometry, pixel_of(i), 0);
        depth[i] = texel.z;
        mirrors[i] = texel.w > 0.0;
    }
    bool is_shared = mirrors[1] && mirrors[2] && !is_cut(depth[1], depth[2]);
    return bvec2(is_shared && mirrors[0] && !is_cut(depth[0], depth[1]) && !is_cut(depth[0], depth[2]),
                 is_shared && mirrors[3] && !is_cut(depth[3], depth[1]) && !is_cut(depth[3], depth[2]));
}
