// The triangle that a pixel's mirrored ray meets, the nearest of those that are drawn.

#include "virtual/met.glsl"

uniform vec2 path;           // the part that the ray leaves, and the one before

flat in ivec2 shown;  // triangle, instance

out uvec2 seen;

const float SLACK = 1e-6;    // so that rays between two triangles meet one

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    vec4 origin = texelFetch(ray_origins, pixel, 0);
    if (origin.w != path.x || texelFetch(ray_directions, pixel, 0).w != path.y) discard;
    vec3 met = met_on(pixel, shown.y, shown.x);
    bool inside = met.x >= -SLACK && met.y >= -SLACK && met.x + met.y <= 1.0 + SLACK;
    if (!inside || !(met.z > 1e-5 * (1.0 + length(origin.xyz)))) discard;
    seen = uvec2(shown.y + 1, shown.x);
    gl_FragDepth = met.z / (1.0 + met.z);
}
