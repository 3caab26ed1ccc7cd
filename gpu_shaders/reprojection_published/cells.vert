// A point for each cell of the grid through the middles of a key frame's pixels (Xie et al., 3.2.2); the geometry
// shader that follows makes two triangles of it.

uniform int columns;  // cells in a row

flat out ivec2 cell;  // the pixel at its lower left

void main() {
    cell = ivec2(gl_VertexID % columns, gl_VertexID / columns);
}
