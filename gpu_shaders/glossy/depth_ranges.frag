// A level of the pyramid of depth ranges: each texel of four by four of the level below, so that neighbours overlap.

uniform sampler2D below;
uniform ivec4 level_below;  // where it lies in its texture: corner and size
uniform ivec2 corner;       // of this level in its own

layout(location = 0) out vec2 range;  // nearest and farthest

vec2 range_below(ivec2 texel) {
    return texelFetch(below, level_below.xy + clamp(texel, ivec2(0), level_below.zw - 1), 0).xy;
}

void main() {
    ivec2 first = 2 * (ivec2(gl_FragCoord.xy) - corner) - 1;
    range = range_below(first);
    for (int i = 1; i < 16; ++i) {
        vec2 other = range_below(first + ivec2(i & 3, i >> 2));
        range = vec2(min(range.x, other.x), max(range.y, other.y));
    }
}
