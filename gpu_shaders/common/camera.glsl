// The ray through a point of the picture.

#include "common/scene.glsl"

uniform mat4 camera_to_world;
uniform vec4 window;       // left, right, bottom, top at distance 1; metres for an orthographic camera
uniform bool orthographic;

// `place` is 0..1 from the lower left corner of the window.
Ray ray_through(vec2 place, vec4 window, bool orthographic, mat4 camera_to_world) {
    vec2 at = mix(window.xz, window.yw, place);
    vec3 origin = orthographic ? vec3(at, 0.0) : vec3(0.0);
    vec3 direction = orthographic ? vec3(0.0, 0.0, -1.0) : normalize(vec3(at, -1.0));
    return Ray((camera_to_world * vec4(origin, 1.0)).xyz, mat3(camera_to_world) * direction);
}

Ray camera_ray(vec2 place) {
    return ray_through(place, window, orthographic, camera_to_world);
}
