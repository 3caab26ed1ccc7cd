// The rays that are mirrored once more, where a mirrored ray has met a reflector.

#include "virtual/rays.glsl"
#include "virtual/met.glsl"
#include "virtual/seen.glsl"

uniform usampler2D virtual_objects;

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    uvec2 seen = texelFetch(virtual_objects, pixel, 0).xy;
    if (seen.x == NOT_SEARCHED || seen.x == WORLD_SEEN || !is_reflector(int(seen.x) - 1)) discard;
    vec3 met = met_on(pixel, int(seen.x) - 1, int(seen.y));
    vec4 origin = texelFetch(ray_origins, pixel, 0);
    vec3 direction = texelFetch(ray_directions, pixel, 0).xyz;
    Surface s = surface_at(Hit(int(seen.x) - 1, int(seen.y), met.xy, met.z), direction);
    if (!s.reflects) discard;
    leave(s, direction, origin.w);
}
