// The pixels that show a mirror, on the depth of the screen's triangle.

#include "common/scene.glsl"
#include "planar/mirror.glsl"

uniform usampler2D visibility;

void main() {
    uvec2 seen = texelFetch(visibility, ivec2(gl_FragCoord.xy), 0).xy;
    if (!shows_mirror(int(seen.x) - 1, int(seen.y))) discard;
}
