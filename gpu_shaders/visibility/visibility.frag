// Which triangle of which instance a pixel shows; shading finds the rest from these two numbers.

uniform int instance;        // plus 1, so that 0 means nothing
uniform int first_triangle;

out uvec2 seen;

void main() {
    seen = uvec2(instance, first_triangle + gl_PrimitiveID);
}
