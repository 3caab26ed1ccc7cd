// The light that arrives at the reflectors, as the viewer sees it in them (Xie et al., 3.3).

#include "common/reflection.glsl"

uniform sampler2D arriving;  // radiance; metres to where it comes from

Mirrored mirrored_light(Surface s, vec3 direction) {
    vec4 light = texelFetch(arriving, ivec2(gl_FragCoord.xy) - corner, 0);
    return Mirrored(reflectance(s, direction) * light.rgb, light.a);
}
