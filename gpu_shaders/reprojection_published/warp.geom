// The key frame's mirrors, with what arrives at them, as the camera of now sees them (Xie et al., 3.2.2, reflection
// warping).

#include "reprojection_published/cells.glsl"

uniform mat4 world_to_clip;
uniform sampler2D image;  // what arrives at the key frame's pixels; alpha is below 0 where that is not known

out vec4 light;
out vec3 position;

vec4 lights[4];

void emit(int corner) {
    light = lights[corner];
    position = known_at(pixel_of(corner)).position;
    gl_Position = world_to_clip * vec4(position, 1.0);
    EmitVertex();
}

void emit_triangle(int a, int b, int c) {
    emit(a);
    emit(b);
    emit(c);
    EndPrimitive();
}

void main() {
    bvec2 whole = are_whole();
    if (!any(whole)) return;
    for (int i = 0; i < 4; ++i) lights[i] = texelFetch(image, pixel_of(i), 0);
    if (lights[1].a < 0.0 || lights[2].a < 0.0) return;
    if (whole[0] && lights[0].a >= 0.0) emit_triangle(0, 1, 2);
    if (whole[1] && lights[3].a >= 0.0) emit_triangle(3, 2, 1);
}
