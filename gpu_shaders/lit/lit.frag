// The scene without reflections: the world, and the light that each surface gives off or scatters.

#include "common/picture.glsl"

uniform float weight;  // of this sample in the pixel

layout(location = 0) out vec4 color;  // radiance; alpha: share that shows a reflector

void main() {
    Ray ray = pixel_ray();
    Hit hit = pixel_hit(ray);
    if (hit.instance == NONE) {
        color = weight * vec4(world_radiance(ray.direction), 0.0);
        return;
    }
    Surface s = surface_at(hit, ray.direction);
    color = weight * vec4(own_radiance(s, reflectance(s, ray.direction)), float(s.reflects));
}
