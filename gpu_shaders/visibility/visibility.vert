// A mesh as the camera sees it.

uniform mat4 object_to_clip;

in vec3 position;

void main() {
    gl_Position = object_to_clip * vec4(position, 1.0);
}
