// What the mirrored ray of a pixel meets on a triangle.

#include "common/scene.glsl"

uniform sampler2D ray_origins;
uniform sampler2D ray_directions;

// Barycentrics of the second and third corner, and distance.
vec3 met_on(ivec2 pixel, int instance, int triangle) {
    mat4x3 inward = world_to_object(instance);
    vec3 origin = texelFetch(ray_origins, pixel, 0).xyz, direction = texelFetch(ray_directions, pixel, 0).xyz;
    return meet_plane(inward * vec4(origin, 1.0), mat3(inward) * direction, triangle_at(triangle));
}
