// Box-projected environment mapping (Lagarde and Zanuttini 2012): the ray goes on to a box around the
// scene, and the cube is looked up towards the point it meets there. Where the cube shows the world at that
// point the box is open: the ray leaves it, and what lies infinitely far away has no parallax.

#include "common/world.glsl"
#include "common/environment.glsl"

// Metres along a ray from within the box of a capture to its side.
float box_distance(int reflector, Ray ray) {
    vec3 ahead = mix(capture_texel(reflector, 1), capture_texel(reflector, 2), greaterThan(ray.direction, vec3(0.0)));
    vec3 reach = (ahead - ray.origin) / mix(ray.direction, vec3(1e-20), equal(ray.direction, vec3(0.0)));
    return max(0.0, min(min(reach.x, reach.y), reach.z));
}

// What a ray shows, and in alpha how much of that is the world.
vec4 boxed(int reflector, Ray ray, float distance) {
    vec3 towards = ray.origin + distance * ray.direction - capture_texel(reflector, 0);
    vec4 seen = environment_surfaces(reflector, towards);
    if (seen.a > 0.0) seen.rgb += seen.a * world_radiance(ray.direction);
    return seen;
}

vec3 boxed_radiance(int reflector, Ray ray) {
    return boxed(reflector, ray, box_distance(reflector, ray)).rgb;
}
