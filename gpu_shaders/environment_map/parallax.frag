// Box-projected environment mapping of the rays that reflectors mirror.

#include "common/reflection.glsl"
#include "environment_map/box.glsl"

Mirrored mirrored_light(Surface s, vec3 direction) {
    int reflector = reflector_of(s.at.instance);
    Ray mirrored = mirrored_ray(s, direction);
    float distance = box_distance(reflector, mirrored);
    vec4 seen = boxed(reflector, mirrored, distance);
    return Mirrored(reflectance(s, direction) * seen.rgb, seen.a < 0.5 ? distance : FAR);
}
