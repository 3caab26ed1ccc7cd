// What the mirrored ray of a pixel meets on a triangle.

#include "common/scene.glsl"

uniform sampler2D ray_origins;
uniform sampler2D ray_directions;

// Barycentrics of the second and third corner, and distance.
vec3 met_on(ivec2 pixel, int instance, int triangle) {
    Ray ray = Ray(texelFetch(ray_origins, pixel, 0).xyz, texelFetch(ray_directions, pixel, 0).xyz);
    return meet_plane_of(instance, triangle, ray);
}

const float SLACK = 1e-6;      // so that rays between two triangles meet one
const float FAR_AWAY = 1e30;

// How far a pixel's mirrored ray gets to a triangle; FAR_AWAY where it does not meet it.
float hit_distance(ivec2 pixel, int instance, int triangle) {
    vec3 met = met_on(pixel, instance, triangle);
    float least = 1e-5 * (1.0 + length(texelFetch(ray_origins, pixel, 0).xyz));
    bool inside = met.x >= -SLACK && met.y >= -SLACK && met.x + met.y <= 1.0 + SLACK;
    return inside && met.z > least ? met.z : FAR_AWAY;
}
