// The world behind everything that a path may show.

#include "virtual/seen.glsl"

uniform sampler2D ray_origins;
uniform sampler2D ray_directions;
uniform vec2 path;  // the part that the ray leaves, and the one before

out uvec2 seen;

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    if (vec2(texelFetch(ray_origins, pixel, 0).w, texelFetch(ray_directions, pixel, 0).w) != path) discard;
    seen = uvec2(WORLD_SEEN, 0u);
}
