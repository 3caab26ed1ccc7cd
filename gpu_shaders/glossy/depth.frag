// How far away everything is that a camera sees, in metres along its axis.

#include "common/picture.glsl"

uniform float weight;  // of the sample; every pass has one

layout(location = 0) out float depth_seen;

void main() {
    Ray ray = pixel_ray();
    Hit hit = pixel_hit(ray);
    if (hit.instance == NONE) discard;
    depth_seen = weight * hit.distance * dot(ray.direction, -camera_to_world[2].xyz);
    if (orthographic) depth_seen = hit.distance;
}
