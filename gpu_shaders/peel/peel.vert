// An object as one axis of its box sees it: u and v across the face, depth handled per fragment.

uniform int axis;  // of the depth; u is the next axis, v the one after

in vec3 place;  // 0..1 in the box

void main() {
    vec2 across = axis == 0 ? place.yz : axis == 1 ? place.zx : place.xy;
    gl_Position = vec4(2.0 * across - 1.0, 0.0, 1.0);
}
