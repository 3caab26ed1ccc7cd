// A triangle that covers the viewport.

uniform float depth;  // -1 near to 1 far

void main() {
    gl_Position = vec4(vec2((gl_VertexID & 1) * 4 - 1, (gl_VertexID >> 1) * 4 - 1), depth, 1.0);
}
