// Captured cubes (addon/baking/environment.py): a row of six faces for each reflector, each with a
// border of one texel, so that bilinear filtering is right at the edges. It is done here: a sampler's own is
// coarser, and rounds otherwise for every number of reflectors.

#include "common/data.glsl"

uniform sampler2D environment;
uniform sampler2D captures;       // 3 texels a reflector: centre | low | high corner of the box around the scene
uniform int environment_size;     // texels along a face

vec3 capture_texel(int reflector, int offset) {
    return texelFetch(captures, texel_at(3 * reflector + offset), 0).xyz;
}

vec3 environment_texel(ivec2 texel) {
    return texelFetch(environment, texel, 0).rgb;
}

vec3 environment_radiance(int reflector, vec3 direction) {
    vec3 size = abs(direction);
    int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    float side = direction[axis] < 0.0 ? -1.0 : 1.0;
    vec2 place = vec2(-side * direction[(axis + 1) % 3], direction[(axis + 2) % 3]) / size[axis];
    vec2 from_first = 0.5 + float(environment_size - 2) * (0.5 + 0.5 * place);
    ivec2 i = ivec2(from_first);
    vec2 f = from_first - vec2(i);
    i += environment_size * ivec2(2 * axis + (side < 0.0 ? 1 : 0), reflector);
    vec3 below = mix(environment_texel(i), environment_texel(i + ivec2(1, 0)), f.x);
    vec3 above = mix(environment_texel(i + ivec2(0, 1)), environment_texel(i + ivec2(1, 1)), f.x);
    return mix(below, above, f.y);
}
