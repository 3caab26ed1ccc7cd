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

// The facet that two uniform numbers draw from the lobe.
Facet facet_of(Lobe lobe, Surface s, vec2 u) {
    vec3 half_way = sample_half(lobe.view, lobe.alpha, u), light = reflect(-lobe.view, half_way);
    // What stays between facets covers what lies under them as little as can be: so Cycles' tables have it.
    vec3 mirrored = reflectance_at(s, light.z > 0.0 ? clamp(dot(lobe.view, half_way), 0.0, 1.0) : 1.0);
    Facet facet = Facet(lobe.frame * light, vec3(0.0), lobe.covers * mirrored);
    if (light.z > 0.0 && dot(facet.direction, s.flat_normal) > 0.0)
        facet.kept = lobe.multiple * mirrored * passed_on(lobe.view, light, lobe.alpha);
    return facet;
}

// What lies under a dielectric was lit as if this were smooth; so much more of it is to be seen, or less.
vec3 uncovered(Surface s, vec3 direction, vec3 covered) {
    if (DIELECTRICS == 0 || s.fresnel != FRESNEL_DIELECTRIC) return vec3(0.0);
    return (reflectance(s, direction) - covered) * scattered(s);
}

// ---- Two numbers for each ray

// 0..1, even over the pixels of a neighbourhood (Jimenez 2014).
float dither(vec2 pixel) {
    return fract(52.9829189 * fract(dot(pixel, vec2(0.06711056, 0.00583715))));
}

// Even over the rays of a pixel, those of all its samples (Roberts 2018), and other in each pixel.
vec2 random(int ray) {
    vec2 start = vec2(dither(gl_FragCoord.xy), dither(gl_FragCoord.xy + vec2(47.0, 17.0)));
    return fract(start + float(ray) * vec2(0.7548776662, 0.5698402910));
}
