// A key frame's reflection buffers as two RGBA textures (Xie et al., 3.1). Normal, depth and specular factor are of
// everything in sight, since a search may lead off the mirrors.

#include "common/picture.glsl"
#include "reprojection_published/known.glsl"

uniform sampler2D traced;  // radiance that arrives at the mirrors, metres that it came

layout(location = 0) out vec4 geometry;  // normal, in two; metres from the camera; specular factor
layout(location = 1) out vec4 light;     // as `traced`

const float MOST = 65504.0;                 // a half float
const float LEAST_SPECULAR = 1.0 / 1024.0;  // of what mirrors at all

// 1 for a perfect mirror, seen from straight above; 0 for what mirrors nothing.
float specular_factor(Surface s) {
    return s.reflects ? clamp(dot(reflectance_at(s, 1.0), LUMINANCE), LEAST_SPECULAR, 1.0) : 0.0;
}

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy) - corner;
    Ray ray = pixel_ray(pixel);
    Hit hit = pixel_hit(ray, pixel);
    if (hit.instance == NONE) discard;
    Surface s = surface_at(hit, ray.direction);
    vec3 normal = s.reflects ? mirror_normal(s, ray.direction) : s.normal;
    vec4 arriving = texelFetch(traced, pixel, 0);
    geometry = vec4(octahedral(normal), hit.distance, specular_factor(s));
    light = vec4(min(arriving.rgb, MOST), min(arriving.a, FARTHEST));
}
