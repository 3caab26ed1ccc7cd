// The world in a captured cube: an alpha below 0 tells it from surfaces.

#include "common/picture.glsl"

uniform float weight;

layout(location = 0) out vec4 color;

void main() {
    Ray ray = pixel_ray();
    if (pixel_hit(ray).instance != NONE) discard;
    color = weight * vec4(world_radiance(ray.direction), -1.0);
}
