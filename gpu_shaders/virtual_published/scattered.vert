// Finds the virtual vertices of points, each in a part of its own.

#include "virtual_published/midpoint.glsl"

in vec3 position;
in int part;

out vec4 image;  // the virtual vertex; w: 0, or 1 where it is hidden by the reflector,
                 // 2 where the part does not reflect it

void main() {
    choose_part(part);
    image = virtual_vertex(follow(position), position);
}
