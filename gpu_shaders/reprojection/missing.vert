// A point for each pixel of the picture (with missing.geom: those that nothing is known of).

uniform sampler2D lights;  // of reflection buffers: alpha is below 0 where light is missing
uniform float least;       // of these, list what is at least this

flat out ivec2 place;
flat out int is_missing;

void main() {
    int width = textureSize(lights, 0).x;
    place = ivec2(gl_VertexID % width, gl_VertexID / width);
    float reason = texelFetch(lights, place, 0).a;
    is_missing = reason < 0.0 && reason >= least ? 1 : 0;
}
