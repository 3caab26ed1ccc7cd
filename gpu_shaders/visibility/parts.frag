// Which part of the picture a pixel shows, as a depth (addon/drawing/visibility.py): a depth test then spares
// a pass all pixels that are not its own. Reflectors count where they are of the group whose pass is next.

#include "common/scene.glsl"

uniform usampler2D visibility;
uniform int group;

const float REFLECTORS = 0.0, OTHERS = 0.5, WORLD = 1.0;

void main() {
    uint seen = texelFetch(visibility, ivec2(gl_FragCoord.xy), 0).x;
    gl_FragDepth = seen == 0u ? WORLD : group_of(int(seen) - 1) == group ? REFLECTORS : OTHERS;
}
