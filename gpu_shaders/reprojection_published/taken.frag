// What a picture takes over: warped reflections that lie on the surface that it shows (Xie et al., 3.2). All else is
// missing.

#include "common/picture.glsl"
#include "reprojection_published/known.glsl"

uniform sampler2D warped;         // radiance, metres to where it comes from; below 0: nothing
uniform sampler2D warped_depths;  // metres from the camera
uniform float epsilon;            // share of the depth by which the two may differ

layout(location = 0) out uvec4 geometry;  // of the reflection buffers: nobody searches in this picture
layout(location = 1) out vec4 light;
layout(location = 2) out uvec4 met;

const float MISSING = -1.0;

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy) - corner;
    Ray ray = pixel_ray(pixel);
    Hit hit = pixel_hit(ray, pixel);
    if (hit.instance == NONE || !is_reflector(hit.instance)) discard;
    if (!surface_at(hit, ray.direction).reflects) discard;
    geometry = met = uvec4(0u);
    light = texelFetch(warped, pixel, 0);
    float off = abs(texelFetch(warped_depths, pixel, 0).x - hit.distance);
    if (light.a < 0.0 || off > epsilon * hit.distance) light = vec4(vec3(0.0), MISSING);
    else if (light.a > 0.5 * FARTHEST) light.a = FAR;
}
