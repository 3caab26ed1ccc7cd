// Depth 0 where the pixel shows a reflector, so that a depth test spares all others the reflection pass.

#include "common/scene.glsl"

uniform usampler2D visibility;

void main() {
    uvec2 seen = texelFetch(visibility, ivec2(gl_FragCoord.xy), 0).xy;
    gl_FragDepth = seen.x != 0u && is_reflector(int(seen.x) - 1) ? 0.0 : 1.0;
}
