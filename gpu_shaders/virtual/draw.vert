// Where a triangle of the scene may be seen in a reflector, a little larger than it is.

uniform vec2 shift;  // of the sample within the pixel

in vec2 corner;      // of a picture from -1 to 1
in ivec2 triangle;    // and its instance

flat out ivec2 shown;

void main() {
    gl_Position = vec4(corner + shift, 0.0, 1.0);
    shown = triangle;
}
