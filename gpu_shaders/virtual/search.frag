// A result, as it is.

flat in vec4 found;
flat in vec4 shown;
flat in vec4 found_again;

layout(location = 0) out vec4 first;
layout(location = 1) out vec4 place;
layout(location = 2) out vec4 second;

void main() {
    first = found;
    place = shown;
    second = found_again;
}
