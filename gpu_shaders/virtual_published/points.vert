// Where a search ends: as published with PUBLISHED 1, else ours.

#include "virtual_published/midpoint.glsl"

in vec3 position;
#if !PUBLISHED
in vec3 start;  // direction in the part's frame; 0: from the beginning
#endif

out vec4 reached;  // the point of the reflector; w: radians from normal to bisector, below 0 where nothing is reflected

void main() {
#if PUBLISHED
    Sight s = follow(position);
#else
    vec4 result = dot(start, start) > 0.0 ? search(start, position) : search(position);
    Sight s = sight_at(point_at(0, place_of(0, result.xyz)), position);
#endif
    reached = vec4(s.position, (s.hidden || s.turned_away ? -2.0 : 2.0) * sqrt(s.error));
}
