// The triangles of a planar reflector that lie in no flat part, a bevelled edge for one.

#include "traced/mirrors.glsl"
#include "planar/mirror.glsl"

bool is_shown(Surface s) {
    return shows_mirror(s.at.instance, s.at.triangle);
}
