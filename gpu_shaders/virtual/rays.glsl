// The mirrored rays of a picture's pixels, and the parts that mirror them.

#include "common/surface.glsl"
#include "virtual/parts.glsl"

layout(location = 0) out vec4 ray_origin;     // w: the part that it leaves, 0 for none
layout(location = 1) out vec4 ray_direction;  // w: the part before that, 0 for none

void leave(Surface s, vec3 direction, float before) {
    Ray ray = mirrored_ray(s, direction);
    ray_origin = vec4(ray.origin, float(part_of(s.at.instance, s.at.triangle)));
    ray_direction = vec4(ray.direction, before);
}
