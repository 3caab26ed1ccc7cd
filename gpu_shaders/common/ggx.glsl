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

// Share of the light along `light` that gets through to `view`, of what a half vector drawn by `sample_half` lets in.
float passed_on(vec3 view, vec3 light, float alpha) {
    float seen = smith_lambda(view, alpha), lit = smith_lambda(light, alpha);
    return (1.0 + seen) / (1.0 + seen + lit);
}

// Columns: two tangents and the normal (Duff and others 2017).
mat3 frame_of(vec3 normal) {
    float side = normal.z >= 0.0 ? 1.0 : -1.0, a = -1.0 / (side + normal.z), b = normal.x * normal.y * a;
    return mat3(vec3(1.0 + side * normal.x * normal.x * a, side * b, -side * normal.x),
                vec3(b, side + normal.y * normal.y * a, -normal.y), normal);
}
