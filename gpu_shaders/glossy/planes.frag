// What an attenuation plane lets through; blending multiplies by it.

flat in float passed;

layout(location = 0) out vec4 color;

void main() {
    color = vec4(vec3(passed), 1.0);
}
