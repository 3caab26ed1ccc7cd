// A result, as it is.

flat in vec4 found;
flat in vec4 shown;

layout(location = 0) out vec4 point;
layout(location = 1) out vec4 place;

void main() {
    point = found;
    place = shown;
}
