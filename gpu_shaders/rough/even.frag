// Evens what rough mirrors show, where that is blurred anyway. A neighbour counts by how far its lobe is off this
// pixel's where the light comes from, in widths of the lobe; the square of neighbours is as wide as that lets it be.

#include "common/picture.glsl"
#include "rough/normals.glsl"
#include "rough/sent.glsl"

uniform sampler2D light;  // as rough/shared.frag writes them
uniform sampler2D kept;
uniform sampler2D beside;
uniform float weight;     // of this sample in the pixel

layout(location = 0) out vec4 color;  // with a STRIDE above 1, over what a perfect mirror keeps, and 1
layout(location = 1) out float distance_to_hit;
layout(location = 2) out vec4 reflection;

const float OFF = 0.5;  // widths of a lobe: a neighbour that is so far off counts half

struct Seen {
    vec3 position, normal;
    float nearness;  // one over the distance of what is mirrored
    vec3 light;
};

Seen seen_at(ivec2 pixel) {
    float away = texelFetch(ends, pixel, 0).w;
    Ray sight = pixel_ray(pixel_of(pixel, away));
    vec4 there = texelFetch(light, pixel, 0);
    vec3 position = sight.origin + away * sight.direction;
    return Seen(position, unpacked_normal(texelFetch(beside, pixel, 0).w), there.w, there.rgb);
}

// How far the lobes are apart, as an angle.
float apart(Seen own, Seen other, vec3 sight, float away) {
    vec3 across = other.position - own.position;
    across -= dot(across, sight) * sight;
    return length(across) * (max(own.nearness, other.nearness) + 1.0 / away) + 2.0 * distance(own.normal, other.normal);
}

// Beside the mirror, what `kept` holds is an earlier picture's.
bool is_rough(ivec2 pixel) {
    bool inside = all(greaterThanEqual(pixel, ivec2(0))) && all(lessThan(pixel, textureSize(kept, 0)));
    return inside && texelFetch(kept, pixel, 0).w > 0.0 && texelFetch(ends, pixel, 0).w > 0.0;
}

void main() {
    ivec2 here = ivec2(gl_FragCoord.xy) - corner;
    vec4 share = texelFetch(kept, here, 0), end = texelFetch(ends, here, 0);
    if (end.w == 0.0) discard;
    if (share.w == 0.0) {
        reflection = color = weight * vec4(texelFetch(light, here, 0).rgb, 0.0);
        distance_to_hit = end.x;
        return;
    }
    Seen own = seen_at(here);
    vec3 sight = pixel_ray(pixel_of(here, end.w)).direction;
    float wide = OFF * share.w;
    ivec2 stride = ivec2(1);
    for (int axis = 0; axis < 2; ++axis) {
        ivec2 next = here;
        next[axis] += 1;
        if (!is_rough(next)) continue;
        stride[axis] = int(clamp(0.5 * wide / apart(own, seen_at(next), sight, end.w), 1.0, float(SIDE)));
    }
    vec3 sum = vec3(0.0);
    float total = 0.0;
    for (int i = 0; i < SIDE * SIDE; ++i) {
        ivec2 there = here + stride * (ivec2(i % SIDE, i / SIDE) - SIDE / 2);
        if (!is_rough(there)) continue;
        Seen other = seen_at(there);
        float part = apart(own, other, sight, end.w) / wide, counts = exp2(-part * part);
        sum += counts * other.light;
        total += counts;
    }
#if STRIDE > 1
    color = vec4(share.rgb * sum / total, 1.0);
    return;
#endif
    vec3 under = texelFetch(beside, here, 0).rgb;
    reflection = color = weight * vec4(share.rgb * sum / total + under, 0.0);
    distance_to_hit = distance(end.xyz, own.position);
}
