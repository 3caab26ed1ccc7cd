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

// Alpha is below 0 where the texel shows the world.
vec4 environment_texel(ivec2 texel) {
    return texelFetch(environment, texel, 0);
}

// Four texels around a direction: the lower left one, and how near the others are.
struct Footprint {
    ivec2 texel;
    vec2 share;
};

Footprint footprint(int reflector, vec3 direction) {
    vec3 size = abs(direction);
    int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    float side = direction[axis] < 0.0 ? -1.0 : 1.0;
    vec2 place = vec2(-side * direction[(axis + 1) % 3], direction[(axis + 2) % 3]) / size[axis];
    vec2 from_first = 0.5 + float(environment_size - 2) * (0.5 + 0.5 * place);
    ivec2 texel = ivec2(from_first);
    vec2 share = from_first - vec2(texel);
    return Footprint(texel + environment_size * ivec2(2 * axis + (side < 0.0 ? 1 : 0), reflector), share);
}

vec4 blended(vec4 a, vec4 b, vec4 c, vec4 d, vec2 share) {
    return mix(mix(a, b, share.x), mix(c, d, share.x), share.y);
}

vec3 environment_radiance(int reflector, vec3 direction) {
    Footprint at = footprint(reflector, direction);
    return blended(environment_texel(at.texel), environment_texel(at.texel + ivec2(1, 0)),
                   environment_texel(at.texel + ivec2(0, 1)), environment_texel(at.texel + ivec2(1, 1)), at.share).rgb;
}

vec4 skyless(vec4 texel) {
    return texel.a < 0.0 ? vec4(0.0, 0.0, 0.0, 1.0) : vec4(texel.rgb, 0.0);
}

// The radiance of surfaces alone; alpha is the share that the world takes.
vec4 environment_surfaces(int reflector, vec3 direction) {
    Footprint at = footprint(reflector, direction);
    return blended(skyless(environment_texel(at.texel)), skyless(environment_texel(at.texel + ivec2(1, 0))),
                   skyless(environment_texel(at.texel + ivec2(0, 1))),
                   skyless(environment_texel(at.texel + ivec2(1, 1))), at.share);
}
