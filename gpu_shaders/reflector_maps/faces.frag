// Position and normal of the reflector where a texel's centre lies (Estalella et al., 4.1).

in vec3 place;
in vec3 direction;

layout(location = 0) out vec4 position;  // alpha: the texel is covered
layout(location = 1) out vec4 normal;

void main() {
    position = vec4(place, 1.0);
    normal = vec4(normalize(direction), 1.0);
}
