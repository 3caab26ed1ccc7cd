// Reflection points of vertices: direction in the frame of the path's first part, and how far the bisector leans,
// below 0 for a vertex behind the reflector.

#include "common/data.glsl"

const vec4 NOT_SOUGHT = vec4(0.0, 0.0, 1.0, 2e30);  // of a vertex that no ray of the path comes by
