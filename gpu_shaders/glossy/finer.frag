// What a rough flat mirror shows by rays that one pixel of every square has sent: the light between them, and the
// mirror's own colour.

#include "common/reflection.glsl"
#include "common/lobe.glsl"
#include "planar/mirror.glsl"
#include "rough/squares.glsl"

uniform sampler2D evened;  // as rough/even.frag writes it
uniform sampler2D beside;  // as rough/shared.frag
uniform sampler2D ends;    // as common/rough.glsl

uniform int number;        // of the sample

const float LEAST = 1e-3;  // what a square counts that is as far as squares lie apart

Mirrored mirrored_light(Surface s, vec3 direction) {
    if (!shows_mirror(s.at.instance, s.at.triangle)) discard;
    vec2 place = (gl_FragCoord.xy - 0.5 - vec2(first_in_square(number))) / float(SQUARE);
    ivec2 first = ivec2(floor(place)), last = textureSize(evened, 0) - 1;
    vec2 part = place - vec2(first);
    vec4 light = vec4(0.0);
    vec3 covered = vec3(0.0);
    for (int i = 0; i < 4; ++i) {
        ivec2 corner_of = ivec2(i & 1, i >> 1), texel = clamp(first + corner_of, ivec2(0), last);
        vec2 near = mix(1.0 - part, part, vec2(corner_of));
        vec4 there = max(near.x * near.y, LEAST) * texelFetch(evened, texel, 0);
        light += there;
        if (DIELECTRICS != 0) covered += there.w * texelFetch(beside, texel, 0).rgb;
    }
    vec3 perfect = reflectance(s, direction) / max(light.w, 1e-20);
    vec3 seen = perfect * light.rgb + uncovered(s, direction, perfect * covered);
    vec4 end = texelFetch(ends, ivec2(gl_FragCoord.xy) / SQUARE, 0);
    return Mirrored(seen, distance(end.xyz, s.position));
}
