// A result, as it is.

flat in vec4 found;

out vec4 result;

void main() {
    result = found;
}
