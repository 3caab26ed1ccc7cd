// What rough mirrors show by the rays of neighbouring pixels, as if they were the pixel's own: each counts by how
// likely this pixel's lobe is to send a ray to where it ends, over how likely its own was (Stachowiak and Uludag 2015).
// So nothing blurs where something touches the mirror, and a narrow lobe takes no other rays than its own.

#include "common/reflection.glsl"
#include "common/lobe.glsl"
#include "rough/normals.glsl"
#include "rough/sent.glsl"

uniform sampler2D arrived;  // as common/rough.glsl writes it

layout(location = 0) out vec4 light;   // the mean that arrives; one over the distance where it comes from
layout(location = 1) out vec4 kept;    // share of it that is mirrored; the lobe's width, 0 if `light` is all there is
layout(location = 2) out vec4 beside;  // what is seen of what lies under the mirror; the mirror's normal, packed
// With a STRIDE above 1, what is kept is a share of what a perfect mirror keeps, and so is what is beside: it covers.

const float UNEVEN = 0.3;   // how far a neighbour may lie from this pixel's plane, over how far away it is
const float HEAVIEST = float(2 * STRIDE * STRIDE);

void show(Surface s, Ray ray) {
    ivec2 here = ivec2(gl_FragCoord.xy) - corner, size = textureSize(arrived, 0);
    vec4 own = texelFetch(arrived, here, 0);
    if (own.w == 0.0) discard;
    light = own;
    kept = beside = vec4(0.0);
    if (own.w < 0.0) return;
    Lobe lobe = lobe_of(s, ray.direction);
    vec3 sum = vec3(0.0), all_kept = vec3(0.0), covered = vec3(0.0);
    float total = 0.0, near = 0.0;
    for (int i = 0; i < SIDE * SIDE; ++i) {
        ivec2 there = here + ivec2(i % SIDE, i / SIDE) - (SIDE - 1) / 2;
        if (any(lessThan(there, ivec2(0))) || any(greaterThanEqual(there, size))) continue;
        vec4 brought = texelFetch(arrived, there, 0), end = texelFetch(ends, there, 0);
        if (brought.w <= 0.0) continue;
        Ray sight = pixel_ray(pixel_of(there, end.w));
        vec3 from = sight.origin + end.w * sight.direction, across = from - s.position;
        if (abs(dot(across, s.flat_normal)) > UNEVEN * length(across)) continue;
        vec3 way = end.xyz - s.position, its_way = end.xyz - from;
        float squared = dot(way, way);
        Facet facet = facet_towards(lobe, s, normalize(way) * lobe.frame);
        float likely = min(facet.density * dot(its_way, its_way) / max(squared * brought.w, 1e-20), HEAVIEST);
        sum += likely * facet.kept * brought.rgb;
        all_kept += likely * facet.kept;
        covered += likely * facet.covered;
        near += likely * inversesqrt(squared);
        total += likely;
    }
    float over = 1.0 / max(total, 1e-20);
    light = vec4(sum / max(all_kept, vec3(1e-20)), over * near);
    kept = vec4(over * all_kept, 2.0 * lobe.alpha * lobe.view.z);  // across the plane of incidence
    beside.w = packed_normal(lobe.frame[2]);
#if STRIDE > 1
    vec3 perfect = max(reflectance(s, ray.direction), 1e-6);
    kept.rgb /= perfect;
    beside.rgb = over * covered / perfect;
#else
    beside.rgb = uncovered(s, ray.direction, over * covered);
#endif
}
