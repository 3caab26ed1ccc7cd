// The world, where nothing stands before it.

#include "common/picture.glsl"

uniform float weight;  // of this sample in the pixel

layout(location = 0) out vec4 color;

void main() {
    Ray ray = pixel_ray();
    if (pixel_hit(ray).instance != NONE) discard;
    color = weight * vec4(world_radiance(ray.direction), 0.0);
}
