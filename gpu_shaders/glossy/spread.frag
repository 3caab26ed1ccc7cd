// A slab, blurred by a kernel of 4 by 4 taps that stand as far apart as its radius asks.

#include "glossy/kernel.glsl"

uniform sampler2D slab_texels;
uniform float apart;  // texels from tap to tap

layout(location = 0) out vec4 color;

void main() {
    vec2 size = vec2(textureSize(slab_texels, 0));
    vec4 sum = vec4(0.0);
    for (int tap = 0; tap < 16; ++tap) {
        vec2 place = gl_FragCoord.xy + apart * (vec2(kernel_place(tap)) - 1.5);
        sum += kernel_weight(tap) * textureLod(slab_texels, place / size, log2(max(apart, 1.0)));
    }
    color = sum;
}
