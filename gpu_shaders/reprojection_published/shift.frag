// The intermediate reflection image: what arrives at the surfaces of the key frame for the camera of now.

in vec4 light;

layout(location = 0) out vec4 shifted;

void main() {
    shifted = light;
}
