// What a rough surface mirrors: light from many directions, drawn one at a time.

#include "common/ggx.glsl"

struct Lobe {
    mat3 frame;     // tangents and normal
    vec3 view;      // way to the viewer, in the frame
    float alpha;
    vec3 multiple;  // what light between facets multiplies the lobe by
    vec3 covers;    // and what it multiplies what facets keep from what lies under them by, as Cycles has it
};

struct Facet {
    vec3 direction;  // in the world: where the light comes from that the facet mirrors to the viewer
    vec3 kept;       // share of it that reaches the viewer, over the chance that the facet was drawn; 0: none gets out
    vec3 covered;    // share that facets like it keep from what lies under the surface
    float density;   // of the chance that it was drawn, over the directions of the light
    vec2 drawn;      // the numbers that drew it
};

// Share of light from anywhere that a facet mirrors on average (dielectrics: the fit of Kulla and Conty 2017).
vec3 mirrored_on_average(Surface s) {
    if (s.fresnel == FRESNEL_SCHLICK) return mix(s.reflection, vec3(1.0), 1.0 / 21.0);
    if (DIELECTRICS != 0 && s.fresnel == FRESNEL_DIELECTRIC)
        return s.reflection * (s.ior - 1.0) / (4.08567 + 1.00071 * s.ior);
    return s.reflection;
}

// The viewer's ray to the surface has `direction`.
Lobe lobe_of(Surface s, vec3 direction) {
    Lobe lobe;
    lobe.frame = frame_of(mirror_normal(s, direction));
    lobe.view = -direction * lobe.frame;
    lobe.view.z = max(lobe.view.z, 1e-4);
    lobe.alpha = alpha_of(s);
    lobe.multiple = lobe.covers = vec3(1.0);
    if (s.multiscatter) {
        lobe.multiple = after_more_facets(lobe.view.z, lobe.alpha, mirrored_on_average(s));
        lobe.covers = lobe.multiple * let_out(lobe.view.z, lobe.alpha);
    }
    return lobe;
}

// The facet that mirrors `light`, in the lobe's frame, to the viewer.
Facet facet_between(Lobe lobe, Surface s, vec3 light, vec3 half_way) {
    // What stays between facets covers what lies under them as little as can be: so Cycles' tables have it.
    vec3 mirrored = reflectance_at(s, light.z > 0.0 ? clamp(dot(lobe.view, half_way), 0.0, 1.0) : 1.0);
    float density = facets_seen(lobe.view, half_way, lobe.alpha);
    Facet facet = Facet(lobe.frame * light, vec3(0.0), lobe.covers * mirrored, density, vec2(0.0));
    if (light.z > 0.0 && dot(facet.direction, s.flat_normal) > 0.0)
        facet.kept = lobe.multiple * mirrored * passed_on(lobe.view, light, lobe.alpha);
    return facet;
}

Facet facet_towards(Lobe lobe, Surface s, vec3 light) {
    vec3 half_way = normalize(light + lobe.view);
    return facet_between(lobe, s, light, half_way.z < 0.0 ? -half_way : half_way);
}

// The facet that two uniform numbers draw from the lobe.
Facet facet_of(Lobe lobe, Surface s, vec2 u) {
    vec3 half_way = sample_half(lobe.view, lobe.alpha, u);
    Facet facet = facet_between(lobe, s, reflect(-lobe.view, half_way), half_way);
    facet.drawn = u;
    return facet;
}

// What lies under a dielectric was lit as if this were smooth; so much more of it is to be seen, or less.
vec3 uncovered(Surface s, vec3 direction, vec3 covered) {
    if (DIELECTRICS == 0 || s.fresnel != FRESNEL_DIELECTRIC) return vec3(0.0);
    return (reflectance(s, direction) - covered) * scattered(s);
}

// ---- Two numbers for each ray

uniform int first_ray;  // of this sample, among all that the pixel's samples look along

// 0..1, even over the pixels of a neighbourhood (Jimenez 2014).
float dither(vec2 pixel) {
    return fract(52.9829189 * fract(dot(pixel, vec2(0.06711056, 0.00583715))));
}

// Even from one ray to the next (Roberts 2018).
vec2 even(int ray) {
    return float(ray) * vec2(0.7548776662, 0.5698402910);
}

// Even over the rays of a pixel, those of all its samples, and other in each pixel.
vec2 random(int ray) {
    return fract(vec2(dither(gl_FragCoord.xy), dither(gl_FragCoord.xy + vec2(47.0, 17.0))) + even(ray));
}

// Two numbers that tell nothing of each other, nor of those of other `v` (Jarzynski and Olano 2020).
vec2 hashed(uvec2 v) {
    v = v * 1664525u + 1013904223u;
    v.x += v.y * 1664525u;
    v.y += v.x * 1664525u;
    v ^= v >> 16u;
    v.x += v.y * 1664525u;
    v.y += v.x * 1664525u;
    v ^= v >> 16u;
    return vec2(v >> 8u) / 16777216.0;
}

// For a ray that is turned once more.
vec2 random(int ray, int turn) {
    return fract(random(0) + hashed(uvec2(ray, turn)));
}

// Even over the pixels of every square of `side` by `side` and the samples of each, of which this is `number`, and yet
// other in each square.
vec2 shared_random(int side, int number) {
    ivec2 place = ivec2(gl_FragCoord.xy) % side;
    vec2 other = hashed(uvec2(gl_FragCoord.xy) + 7919u * uint(number));
    return fract(even(place.x + side * (place.y + side * number)) + other / float(side));
}
