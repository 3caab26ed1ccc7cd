// One pass of depth peeling (Zhang et al., 3.4): says what lies at the depth that the last pass
// found, and finds the next depth behind it.
//
// The depth is computed here, from the triangle's plane, so that every pass compares the same float;
// MAX blending keeps the nearest of all fragments whatever their order, in full 32 bits.

#include "common/data.glsl"

// 2 texels a triangle: u, v, depth of a corner, least depth | slopes, greatest depth, solid
uniform sampler2D planes;
uniform sampler2D previous;  // what this shader wrote in the last pass
uniform vec2 shape;          // texels along u and v
uniform float side;          // 1 peels from the low face on, -1 from the high one

// Minus the next depth, times `side` (MAX), triangle + 1 that faces the eye (MAX), triangle + 1 that faces
// away (MAX), solids entered minus solids left (ADD).
out vec4 found;

const float NOTHING = -2.0;

void main() {
    vec4 corner = texelFetch(planes, texel_at(2 * gl_PrimitiveID), 0);
    vec4 slope = texelFetch(planes, texel_at(2 * gl_PrimitiveID + 1), 0);
    vec2 across = gl_FragCoord.xy / shape - corner.xy;
    float depth = side * clamp(corner.z + dot(slope.xy, across), corner.w, slope.z);
    float reached = -texelFetch(previous, ivec2(gl_FragCoord.xy), 0).x;
    if (depth < reached) discard;
    if (depth > reached) {
        found = vec4(-depth, 0.0, 0.0, 0.0);
        return;
    }
    // The rasteriser's own facing, not the normal's: only it sums to zero over a closed surface
    // at every texel.
    bool solid = slope.w > 0.0, front = gl_FrontFacing || !solid;
    float triangle = float(gl_PrimitiveID + 1);
    found = vec4(NOTHING, front ? triangle : 0.0, front ? 0.0 : triangle, solid ? (front ? 1.0 : -1.0) : 0.0);
}
