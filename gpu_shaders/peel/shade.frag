// Colour and normal of the crossings that the peel found, one a fragment.

#include "common/lighting.glsl"

uniform usampler2D crossings;  // 1 texel a crossing: texel of the face, triangle of the mesh
uniform int count;
uniform int instance;
uniform int first_triangle;
uniform int axis;
uniform ivec2 shape;           // texels along u and v
uniform vec3 box_low;
uniform vec3 box_size;

layout(location = 0) out vec4 color;
layout(location = 1) out vec4 normal;  // in the mesh's space, on the eye's side

vec2 across(vec3 v) {
    return axis == 0 ? v.yz : axis == 1 ? v.zx : v.xy;
}

float doubled_area(vec2 a, vec2 b) {
    return a.x * b.y - a.y * b.x;
}

// Weights of the second and third corner at `at`, or of the point of the triangle near it: the
// rasteriser moves corners by a fraction of a texel, so the centre may lie a little outside.
vec2 barycentric_at(Triangle t, vec2 at) {
    vec2 a = across(t.a) - at, b = across(t.b) - at, c = across(t.c) - at;
    float whole = doubled_area(b - a, c - a);
    vec3 part = vec3(doubled_area(b, c), doubled_area(c, a), doubled_area(a, b));
    if (abs(whole) < 1e-30) return vec2(1.0 / 3.0);
    vec3 weight = max(part / whole, 0.0);
    return (weight / (weight.x + weight.y + weight.z)).yz;
}

void main() {
    int index = int(gl_FragCoord.x) + 4096 * int(gl_FragCoord.y);
    if (index >= count) discard;
    uvec2 crossing = texelFetch(crossings, texel_at(index), 0).xy;
    int texel = int(crossing.x), triangle = first_triangle + int(crossing.y);
    vec2 place = (vec2(texel % shape.x, texel / shape.x) + 0.5) / vec2(shape);
    Triangle t = triangle_at(triangle);
    vec2 barycentric = barycentric_at(t, across(box_low) + place * across(box_size));

    // Crossings come in pairs: where the low face sees a layer begin, where the high face does.
    vec3 inward = vec3(axis == 0, axis == 1, axis == 2) * ((index & 1) == 0 ? 1.0 : -1.0);
    vec3 direction = normalize(mat3(object_to_world(instance)) * inward);
    Surface s = surface_at(Hit(instance, triangle, barycentric, 0.0), direction);
    color = vec4(own_radiance(s, direction), 1.0);

    vec3 weight = vec3(1.0 - barycentric.x - barycentric.y, barycentric), smooth_normal = vec3(0.0);
    for (int i = 0; i < 3; ++i) smooth_normal += weight[i] * texelFetch(corners, texel_at(6 * triangle + i), 0).xyz;
    smooth_normal /= max(length(smooth_normal), 1e-30);
    normal = vec4(dot(cross(t.b - t.a, t.c - t.a), inward) > 0.0 ? -smooth_normal : smooth_normal, 0.0);
}
