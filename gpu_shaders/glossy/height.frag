// How high above the mirror everything is that its camera sees.

#include "common/picture.glsl"

uniform float weight;  // of the sample; every pass has one
uniform vec4 mirror_plane;

layout(location = 0) out float height;

void main() {
    Ray ray = pixel_ray();
    Hit hit = pixel_hit(ray);
    if (hit.instance == NONE) discard;
    height = weight * dot(mirror_plane, vec4(ray.origin + hit.distance * ray.direction, 1.0));
}
