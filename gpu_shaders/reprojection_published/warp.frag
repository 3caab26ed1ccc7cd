// What arrives at the key frame's mirrors, and how far from the camera of now these are.

#include "common/camera.glsl"

in vec4 light;
in vec3 position;

layout(location = 0) out vec4 warped;
layout(location = 1) out float depth;  // metres

void main() {
    vec3 way = position - camera_to_world[3].xyz;
    warped = light;
    depth = orthographic ? -dot(way, camera_to_world[2].xyz) : length(way);
}
