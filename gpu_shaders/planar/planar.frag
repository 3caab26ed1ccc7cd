// A flat mirror shows the picture that the mirrored camera saw, at the same place of the screen.

#include "common/reflection.glsl"
#include "planar/mirror.glsl"
#include "planar/mirrored.glsl"

Mirrored mirrored_light(Surface s, vec3 direction) {
    if (!shows_mirror(s.at.instance, s.at.triangle)) discard;
    return Mirrored(reflectance(s, direction) * mirrored_radiance(), mirrored_distance(mirrored_ray(s, direction)));
}
