// The microfacet lobe of a rough mirror: GGX with Smith's shadowing, in the frame where the normal is +Z.

const float TAU = 6.28318530718;
const float SHARP = 1e-4;  // an alpha below which a mirror is a mirror

// A half vector among those that `view` sees, from two uniform numbers (Dupuy and Benyoub 2023).
vec3 sample_half(vec3 view, float alpha, vec2 u) {
    vec3 stretched = normalize(vec3(alpha * view.xy, view.z));
    float z = (1.0 - u.y) * (1.0 + stretched.z) - stretched.z;
    float radius = sqrt(clamp(1.0 - z * z, 0.0, 1.0));
    vec3 sphere = vec3(radius * cos(TAU * u.x), radius * sin(TAU * u.x), z) + stretched;
    return normalize(vec3(alpha * sphere.xy, max(sphere.z, 1e-6)));
}

float smith_lambda(vec3 direction, float alpha) {
    float slope = alpha * alpha * dot(direction.xy, direction.xy) / max(direction.z * direction.z, 1e-12);
    return 0.5 * (sqrt(1.0 + slope) - 1.0);
}

// How likely `sample_half` is to draw a half vector, over the directions that it mirrors to `view`; but for a factor 4.
float facets_seen(vec3 view, vec3 half_way, float alpha) {
    float squared = alpha * alpha, falls = (squared - 1.0) * half_way.z * half_way.z + 1.0;
    return 2.0 * squared / (TAU * falls * falls * view.z * (1.0 + smith_lambda(view, alpha)));
}

// Share of the light along `light` that gets through to `view`, of what a half vector drawn by `sample_half` lets in.
float passed_on(vec3 view, vec3 light, float alpha) {
    float seen = smith_lambda(view, alpha), lit = smith_lambda(light, alpha);
    return (1.0 + seen) / (1.0 + seen + lit);
}

// ---- What the lobe lets out of what it gets

// Share of all light that gets out, after one facet that mirrors everything, to a viewer at the angle of `cosine`.
// Fitted to the integral, for any angle and an alpha from 0 to 1: at most 0.006 off.
float let_out(float cosine, float alpha) {
    const mat4 FIT = mat4(0.048, -0.476, 3.043, -2.756, -0.179, 1.759, -4.278, 1.958,
                          0.290, 1.393, 0.554, 9.134, -0.140, 0.407, -4.198, 0.114);
    float x = cosine / max(cosine + alpha, 1e-6);
    vec4 powers = vec4(1.0, alpha, alpha * alpha, alpha * alpha * alpha);
    return 1.0 - (1.0 - x) * dot(vec4(1.0, x, x * x, x * x * x), FIT * powers);
}

// Its mean over all viewers, weighted by the cosine; at most 0.003 off.
float let_out_on_average(float alpha) {
    return 1.0 - alpha * (0.1280 + alpha * (1.8463 + alpha * (0.8327 * alpha - 2.2148)));
}

// How much more than after one facet gets out after any number, where facets mirror `share` of the light on average:
// as Cycles has it (after Kulla and Conty 2017 and Turquin 2019), the lobe keeps its shape.
vec3 after_more_facets(float cosine, float alpha, vec3 share) {
    float once = let_out(cosine, alpha), average = let_out_on_average(alpha);
    vec3 more = share * average / (1.0 - share * (1.0 - average));
    return 1.0 + more * (1.0 - once) / once;
}

// Columns: two tangents and the normal (Duff and others 2017).
mat3 frame_of(vec3 normal) {
    float side = normal.z >= 0.0 ? 1.0 : -1.0, a = -1.0 / (side + normal.z), b = normal.x * normal.y * a;
    return mat3(vec3(1.0 + side * normal.x * normal.x * a, side * b, -side * normal.x),
                vec3(b, side + normal.y * normal.y * a, -normal.y), normal);
}
