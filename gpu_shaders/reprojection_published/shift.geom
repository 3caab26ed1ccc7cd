// Reflections go to where they are reflected now (Xie et al., 3.2.2, reflection shifting).

#include "reprojection_published/cells.glsl"

uniform isampler2D offsets;
uniform float magnification;  // of a triangle's area, at most

out vec4 light;

const float TRIANGLE = 0.5;  // area of half a cell, in pixels

vec2 moved_to[4];

// What stands behind other reflections is farther on the way by way of the mirror.
void emit(int corner) {
    ivec2 pixel = pixel_of(corner);
    light = light_known_at(pixel);
    float way = texelFetch(known_geometry, pixel, 0).z + light.a;
    vec2 place = (moved_to[corner] + 0.5) / vec2(textureSize(known_geometry, 0));
    gl_Position = vec4(2.0 * place - 1.0, 1.0 - 2.0 / (1.0 + way), 1.0);
    EmitVertex();
}

void emit_triangle(int a, int b, int c) {
    vec2 ab = moved_to[b] - moved_to[a], ac = moved_to[c] - moved_to[a];
    if (0.5 * abs(ab.x * ac.y - ab.y * ac.x) > magnification * TRIANGLE) return;
    emit(a);
    emit(b);
    emit(c);
    EndPrimitive();
}

void main() {
    bvec2 whole = are_whole();
    if (!any(whole)) return;
    bvec4 moved;
    for (int i = 0; i < 4; ++i) {
        ivec2 offset = texelFetch(offsets, pixel_of(i), 0).xy;
        moved[i] = offset.x != INVALID;
        moved_to[i] = vec2(pixel_of(i) + offset);
    }
    if (!moved[1] || !moved[2]) return;
    if (whole[0] && moved[0]) emit_triangle(0, 1, 2);
    if (whole[1] && moved[3]) emit_triangle(3, 2, 1);
}
