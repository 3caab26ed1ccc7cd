// Where a search ends: as published with PUBLISHED 1, else ours.

#include "virtual_published/midpoint.glsl"

in vec3 position;

out vec4 reached;  // the point of the reflector; w: how the bisector leans off its normal, below 0 for a hidden vertex

void main() {
#if PUBLISHED
    Sight s = follow(position);
    bool unseen = s.hidden || s.turned_away;
    reached = vec4(s.position, (unseen ? -2.0 : 2.0) * sqrt(s.error));
#else
    vec4 found = search(position);
    reached = vec4(point_at(0, place_of(0, found.xyz)).position, found.w);
#endif
}
