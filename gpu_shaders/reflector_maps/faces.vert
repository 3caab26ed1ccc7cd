// A part of a reflector as a face of its cube map sees it from the part's centre.

uniform int axis;       // 0 to 2: the face looks along it,
uniform float side;     // 1 or -1 way
uniform float scale;    // what of the face is within the border, over the tangent that it reaches to

in vec3 position;       // in the part's frame, from its centre

void main() {
    float ahead = side * position[axis];
    gl_Position = vec4(-side * scale * position[(axis + 1) % 3], scale * position[(axis + 2) % 3], 0.0, ahead);
}
