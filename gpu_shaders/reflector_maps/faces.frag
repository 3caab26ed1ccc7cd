// Which triangle of the reflector lies where a texel's centre looks (Estalella et al., 4.1), counted from 1.

layout(location = 0) out uint shown;

void main() {
    shown = uint(gl_PrimitiveID + 1);
}
