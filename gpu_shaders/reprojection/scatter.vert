// Gathered pixels go back to their places.

uniform vec2 size;  // of the picture, in pixels

in uvec2 pixel;

flat out int number;

void main() {
    number = gl_VertexID;
    gl_Position = vec4((vec2(pixel) + 0.5) / size * 2.0 - 1.0, 0.0, 1.0);
    gl_PointSize = 1.0;
}
