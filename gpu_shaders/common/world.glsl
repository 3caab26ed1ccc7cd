// What lies behind everything.

#include "common/image.glsl"

uniform vec3 world_color;
uniform int world_panorama;  // an image, or NONE

const float PI = 3.14159265358979;

// Cycles' equirectangular mapping: the poles repeat no row, the seam wraps.
vec3 world_radiance(vec3 direction) {
    if (world_panorama == NONE) return world_color;
    vec2 uv = vec2(0.5 - atan(direction.y, direction.x) / (2.0 * PI),
                   0.5 + atan(direction.z, length(direction.xy)) / PI);
    return image_at(world_panorama, uv, LINEAR, REPEAT, FLOATS).rgb;
}
