// What gathered pixels keep, back at their places.

uniform sampler2D lights;  // row by row
uniform usampler2D geometries, mets;

flat in int number;

layout(location = 0) out uvec4 geometry;
layout(location = 1) out vec4 light;
layout(location = 2) out uvec4 met;

void main() {
    int width = textureSize(lights, 0).x;
    ivec2 place = ivec2(number % width, number / width);
    geometry = texelFetch(geometries, place, 0);
    light = texelFetch(lights, place, 0);
    met = texelFetch(mets, place, 0);
}
