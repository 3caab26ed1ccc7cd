// A polished floor shows the mirrored picture as it has been attenuated and blurred.

#include "common/reflection.glsl"
#include "planar/mirror.glsl"
#include "planar/mirrored.glsl"

uniform vec2 shift;      // 0..1: from where something is in the picture to where the kernel has put it
uniform float strength;  // what is left of the light before any plane
uniform bool by_angle;   // Fresnel is taken here, since no planes bring it

vec3 blurred_radiance() {
    if (!filtered) return mirrored_radiance();
    vec4 seen = texture(mirrored, mirrored_place() + shift);
    return seen.rgb / max(seen.a, 1e-6);
}

Mirrored mirrored_light(Surface s, vec3 direction) {
    if (!shows_mirror(s.at.instance, s.at.triangle)) discard;
    vec3 kept = by_angle || s.fresnel != FRESNEL_DIELECTRIC ? reflectance(s, direction) : s.reflection;
    return Mirrored(strength * kept * blurred_radiance(), mirrored_distance(mirrored_ray(s, direction)));
}
