// The triangle that a pixel's mirrored ray meets, the nearest of those that are drawn.

#include "virtual/met.glsl"

uniform vec2 path;           // the part that the ray leaves, and the one before

flat in ivec2 shown;  // triangle, instance

out uvec2 seen;

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    vec2 parts = vec2(texelFetch(ray_origins, pixel, 0).w, texelFetch(ray_directions, pixel, 0).w);
    if (parts != path) discard;
    float distance = hit_distance(pixel, shown.y, shown.x);
    if (distance == FAR_AWAY) discard;
    seen = uvec2(shown.y + 1, shown.x);
    gl_FragDepth = distance / (1.0 + distance);
}
