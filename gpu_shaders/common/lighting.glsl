// The light that leaves a surface by itself, before anything is mirrored in it.

#include "common/surface.glsl"
#include "common/world.glsl"
#include "common/lamps.glsl"

const int UNLIT = 0, LIGHTMAPS = 1, DIRECT = 2;

uniform int lighting;

vec3 scattered(Surface s) {
    if (lighting == UNLIT) return s.emits ? vec3(0.0) : s.base * (s.reflects ? s.diffuse : 1.0);
    vec3 irradiance = vec3(0.0);
    if (lighting == DIRECT) irradiance = lamp_light(s) + world_light(s.normal);
    else if (s.lightmap != NONE) irradiance = image_at(s.lightmap, s.lightmap_uv, LINEAR, EXTEND).rgb;
    return s.base * s.diffuse * irradiance;
}

// `mirrored` is the share that the surface reflects; a dielectric scatters only what passes it.
vec3 own_radiance(Surface s, vec3 mirrored) {
    vec3 passed = s.reflects && s.fresnel == FRESNEL_DIELECTRIC ? 1.0 - mirrored : vec3(1.0);
    return s.emission + passed * scattered(s);
}
