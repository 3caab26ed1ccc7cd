// The rays that reflectors mirror towards the camera.

#include "common/picture.glsl"
#include "virtual/rays.glsl"

void main() {
    Ray ray = pixel_ray();
    Hit hit = pixel_hit(ray);
    if (hit.instance == NONE || !is_reflector(hit.instance)) discard;
    Surface s = surface_at(hit, ray.direction);
    if (!s.reflects) discard;
    leave(s, ray.direction, 0.0);
}
