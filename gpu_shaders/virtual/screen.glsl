// Where reflection points lie on the screen.

#include "virtual/newton.glsl"

uniform mat4 world_to_clip;
uniform vec2 screen;  // pixels

uniform bool concave;  // a mirror on the path is hollow: what it shows comes apart at its caustics

const float PATCH_BEND = 0.1;

// Pixels from the middle, and w of clip space: above 0 before the camera.
vec4 shown_at(vec3 direction) {
    vec4 clip = world_to_clip * vec4(point_at(0, place_of(0, direction)).position, 1.0);
    return vec4(0.5 * screen * clip.xy / clip.w, clip.w, 0.0);
}

// How far, in pixels, the image of an edge may bend away from the line between its ends: on a whole body as an arc
// over the angle that the reflector turns by does.
float bend(vec3 direction_a, vec3 direction_b, vec2 a, vec2 b) {
    float share = PATCH_BEND;
    if (ORDER == 1 && is_whole(0)) share = acos(clamp(dot(direction_a, direction_b), -1.0, 1.0)) / 8.0;
    return share * distance(a, b);
}
