// How far from a plane everything is that a camera sees.

#include "common/picture.glsl"

uniform float weight;  // of the sample; every pass has one
uniform vec4 plane;

layout(location = 0) out float distance_to_plane;

void main() {
    Ray ray = pixel_ray();
    Hit hit = pixel_hit(ray);
    if (hit.instance == NONE) discard;
    distance_to_plane = weight * dot(plane, vec4(ray.origin + hit.distance * ray.direction, 1.0));
}
