// The surfaces without reflections: the light that each gives off or scatters.

#include "common/picture.glsl"

uniform float weight;  // of this sample in the pixel

layout(location = 0) out vec4 color;  // radiance; alpha: share that shows a reflector

void main() {
    Ray ray = pixel_ray();
    Hit hit = pixel_hit(ray);
    if (hit.instance == NONE) discard;
    Surface s = surface_at(hit, ray.direction);
    color = weight * vec4(own_radiance(s, ray.direction), float(s.reflects));
}
