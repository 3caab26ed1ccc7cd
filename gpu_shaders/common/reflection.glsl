// The frame of a reflection pass. A method's shader includes this and defines `mirrored_light`.

#include "common/picture.glsl"
#include "common/mirrored.glsl"

uniform float weight;  // of this sample in the pixel

layout(location = 0) out vec4 color;
layout(location = 1) out float distance_to_hit;
layout(location = 2) out vec4 reflection;  // `color` once more, where a target keeps it apart

// `s` is the point on the reflector; the viewer's ray to it has `direction`.
Mirrored mirrored_light(Surface s, vec3 direction);

void main() {
    Ray ray = pixel_ray();
    Hit hit = pixel_hit(ray);
    if (hit.instance == NONE || !is_reflector(hit.instance)) discard;
    Surface s = surface_at(hit, ray.direction);
    if (!s.reflects) discard;
    Mirrored mirrored = mirrored_light(s, ray.direction);
    reflection = color = weight * vec4(mirrored.radiance, 0.0);
    distance_to_hit = mirrored.distance;
}
