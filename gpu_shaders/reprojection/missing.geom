// Keeps the points of missing.vert that are to be traced.

layout(points) in;
layout(points, max_vertices = 1) out;

flat in ivec2 place[];
flat in int is_missing[];

flat out uvec2 pixel;

void main() {
    if (is_missing[0] == 0) return;
    pixel = uvec2(place[0]);
    EmitVertex();
}
