// The frame of a reflection pass. A method's shader includes this and defines `mirrored_light`.

#include "common/picture.glsl"
#include "common/mirrored.glsl"

#ifndef SHARED
#define SHARED 0  // what is drawn is a picture, not what rays bring (common/rough.glsl)
#endif

struct Mirrored {
    vec3 radiance;   // what the viewer sees in the surface, its reflectance counted in
    float distance;  // metres from the surface to what is seen; FAR for the world
};

#if SHARED == 0

uniform float weight;  // of this sample in the pixel

layout(location = 0) out vec4 color;
layout(location = 1) out float distance_to_hit;
layout(location = 2) out vec4 reflection;  // `color` once more, where a target keeps it apart

// `s` is the point on the reflector; the viewer's ray to it has `direction`.
Mirrored mirrored_light(Surface s, vec3 direction);

void show(Surface s, Ray ray) {
    Mirrored mirrored = mirrored_light(s, ray.direction);
    reflection = color = weight * vec4(mirrored.radiance, 0.0);
    distance_to_hit = mirrored.distance;
}

#else

void show(Surface s, Ray ray);  // writes what the shader's own outputs are

#endif

void main() {
    ivec2 pixel = own_pixel();
    Ray ray = pixel_ray(pixel);
    Hit hit = pixel_hit(ray, pixel);
    if (hit.instance == NONE || !is_reflector(hit.instance)) discard;
    Surface s = surface_at(hit, ray.direction);
    if (!s.reflects) discard;
    show(s, ray);
}
