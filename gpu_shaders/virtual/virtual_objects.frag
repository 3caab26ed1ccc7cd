// Reflections by virtual objects (after Estalella et al.): the triangle that the mirrored ray meets was found by
// drawing every triangle where its vertices are reflected. What is mirrored more often than that shows its
// environment map.

#include "common/reflection.glsl"
#include "environment_map/box.glsl"
#include "virtual/parts.glsl"

uniform usampler2D virtual_objects;        // what the mirrored rays meet
uniform usampler2D virtual_objects_again;  // and those that are mirrored once more
uniform int orders;
uniform bool goes_on;                      // whether light may be mirrored more often than that, before it goes black

Hit met_by(usampler2D seen_there, Ray ray) {
    uvec2 seen = texelFetch(seen_there, ivec2(gl_FragCoord.xy), 0).xy;
    if (seen.x == 0u) return Hit(NONE, NONE, vec2(0.0), FAR);
    int instance = int(seen.x) - 1;
    mat4x3 inward = world_to_object(instance);
    vec3 met = meet_plane(inward * vec4(ray.origin, 1.0), mat3(inward) * ray.direction, triangle_at(int(seen.y)));
    return Hit(instance, int(seen.y), met.xy, met.z);
}

Mirrored mirrored_light(Surface s, vec3 direction) {
    Mirrored sum = Mirrored(vec3(0.0), FAR);
    vec3 passed = vec3(1.0);
    for (int i = 0; i < orders; ++i) {
        passed *= reflectance(s, direction);
        Ray ray = mirrored_ray(s, direction);
        direction = ray.direction;
        Hit hit = i == 0 ? met_by(virtual_objects, ray) : met_by(virtual_objects_again, ray);
        if (i == 0) sum.distance = hit.distance;
        if (hit.instance == NONE) {
            sum.radiance += passed * world_radiance(direction);
            return sum;
        }
        s = surface_at(hit, direction);
        sum.radiance += passed * own_radiance(s, direction);
        if (!s.reflects) return sum;
    }
    if (!goes_on) return sum;
    Ray ray = mirrored_ray(s, direction);
    sum.radiance += passed * reflectance(s, direction) * boxed_radiance(ordinal_of(s.at.instance), ray);
    return sum;
}
