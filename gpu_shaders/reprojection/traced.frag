// The mirrored rays, traced: a key frame, or what is missing of another picture.

#include "reprojection/kept.glsl"

void main() {
    ivec2 pixel = asked();
    Ray ray = pixel_ray(pixel);
    Hit hit = pixel_hit(ray, pixel);
    if (hit.instance == NONE || !is_reflector(hit.instance)) discard;
    Surface s = surface_at(hit, ray.direction);
    if (!s.reflects) discard;
    keep(s, ray.direction, traced_path(s, ray.direction), true);
}
