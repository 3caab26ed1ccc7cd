// The mirrored picture, convolved. A texel holds what lies around its upper right corner: the kernel is even.

#include "glossy/kernel.glsl"

uniform sampler2D mirrored;

layout(location = 0) out vec4 color;

void main() {
    ivec2 first = ivec2(gl_FragCoord.xy) - 1, last = textureSize(mirrored, 0) - 1;
    vec3 sum = vec3(0.0);
    for (int tap = 0; tap < 16; ++tap)
        sum += kernel_weight(tap) * texelFetch(mirrored, clamp(first + kernel_place(tap), ivec2(0), last), 0).rgb;
    color = vec4(sum, 1.0);
}
