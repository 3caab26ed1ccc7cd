// The light that leaves a surface by itself, before anything is mirrored in it.

#include "common/surface.glsl"
#include "common/world.glsl"
#include "common/lamps.glsl"

#define UNLIT 0
#define LIGHTMAPS 1
#define DIRECT 2

// LIGHTING, one of these, is defined by the program: a compiler then drops the others.

vec3 scattered(Surface s) {
#if LIGHTING == UNLIT
    return s.emits ? vec3(0.0) : s.base * (s.reflects ? s.diffuse : 1.0);
#elif LIGHTING == LIGHTMAPS
    if (s.lightmap == NONE) return vec3(0.0);
    return s.base * s.diffuse * image_at(s.lightmap, s.lightmap_uv, LINEAR, EXTEND, FLOATS).rgb;
#else
    return s.base * s.diffuse * (lamp_light(s) + world_light(s.normal));
#endif
}

// Towards a viewer whose ray has `direction`. A dielectric scatters only what it does not reflect.
vec3 own_radiance(Surface s, vec3 direction) {
    vec3 passed = vec3(1.0);
    if (DIELECTRICS != 0 && s.fresnel == FRESNEL_DIELECTRIC) passed -= reflectance(s, direction);
    return s.emission + passed * scattered(s);
}

// GGX's alpha, the square of Blender's roughness. Unlit reflectors are perfect mirrors, as in the reference.
float alpha_of(Surface s) {
#if LIGHTING == UNLIT
    return 0.0;
#else
    return s.roughness * s.roughness;
#endif
}
