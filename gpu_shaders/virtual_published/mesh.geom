// A triangle of a virtual mesh, with what tells where in it a fragment is. Those of which nothing is reflected are
// left out (Estalella et al., 6.1).

layout(triangles) in;
layout(triangle_strip, max_vertices = 3) out;

#include "common/data.glsl"

uniform mat4 world_to_clip;
uniform isampler2D sources;        // which triangle of which instance each is a piece of
uniform sampler2D source_corners;  // 3 texels a triangle: barycentrics in there of its corners
uniform int first_triangle;

in vec4 image[];
in vec3 original[];

out vec2 barycentric;
out vec3 mirrored;
flat out ivec2 source;
flat out int straddles;      // whether a part of it may be hidden

const float ALL = 0.999;     // of what is interpolated
const float HIDDEN = 1.5;    // above it, the vertex has no image, and so the triangle has none

void main() {
    vec3 hidden = vec3(image[0].w, image[1].w, image[2].w);
    if (all(greaterThan(hidden, vec3(ALL))) || any(greaterThan(hidden, vec3(HIDDEN)))) return;
    int triangle = first_triangle + gl_PrimitiveIDIn;
    for (int i = 0; i < 3; ++i) {
        gl_Position = world_to_clip * vec4(image[i].xyz, 1.0);
        mirrored = original[i];
        barycentric = texelFetch(source_corners, texel_at(3 * triangle + i), 0).xy;
        source = texelFetch(sources, texel_at(triangle), 0).xy;
        straddles = any(greaterThan(hidden, vec3(0.0))) ? 1 : 0;
        EmitVertex();
    }
}
