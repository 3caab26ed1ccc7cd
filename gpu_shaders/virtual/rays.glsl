// The mirrored rays of a picture's pixels, and the parts that mirror them.

#include "common/surface.glsl"
#include "virtual/parts.glsl"

layout(location = 0) out vec4 ray_origin;     // w: the part that it leaves, 0 for none
layout(location = 1) out vec4 ray_direction;  // w: the part before that, 0 for none

// Whole bodies are searched from outside alone; a ray that mirrors in one's inside is left to what draws the rest.
bool is_inside(Surface s, vec3 direction, bool is_whole) {
    Triangle t = triangle_at(s.at.triangle);
    return is_whole && dot(cross(t.b - t.a, t.c - t.a), mat3(world_to_object(s.at.instance)) * direction) > 0.0;
}

void leave(Surface s, vec3 direction, float before) {
    uvec2 part = part_texel(s.at.instance, s.at.triangle);
    if (is_inside(s, direction, part.y != 0u)) discard;
    Ray ray = mirrored_ray(s, direction);
    ray_origin = vec4(ray.origin, float(part.x));
    ray_direction = vec4(ray.direction, before);
}
