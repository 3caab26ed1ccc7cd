// What of the mirrored picture lies in a slab above the mirror, and nothing else.

uniform sampler2D mirrored;
uniform sampler2D heights;
uniform vec2 slab;  // metres, from and below

layout(location = 0) out vec4 color;  // alpha: whether it lies in the slab

void main() {
    ivec2 place = ivec2(gl_FragCoord.xy);
    float height = max(texelFetch(heights, place, 0).x, 0.0);
    bool inside = height >= slab.x && height < slab.y;
    color = inside ? vec4(texelFetch(mirrored, place, 0).rgb, 1.0) : vec4(0.0);
}
