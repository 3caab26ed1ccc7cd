// Potential reflection regions (Zhang et al., 3.2): whether a reflector's triangle meets the cone around
// the bounding sphere of each object's virtual image. One word of 32 objects a fragment.

#include "common/scene.glsl"

uniform sampler2D spheres;   // 1 texel an instance: world centre, radius; negative where nothing is reflected
uniform int objects;
uniform int reflector;       // instance
uniform int first_triangle;  // of its mesh
uniform int triangles;
uniform int region_words;
uniform int first_row;
uniform vec3 eye;
uniform bool orthographic;   // no eye, so no cone: every triangle may show everything

layout(location = 0) out uint mask;

// A cone from the eye. Distances of a point off its axis are held against `slope` times those along it:
// the published form, a ratio of squares, loses its digits where the cone is narrow.
struct Cone {
    vec3 axis;    // unit
    float slope;  // tangent of half the opening
};

bool in_cone(Cone cone, vec3 from_eye) {
    float along = dot(from_eye, cone.axis);
    vec3 off = from_eye - along * cone.axis;
    return along >= 0.0 && dot(off, off) <= cone.slope * cone.slope * along * along;
}

// An edge whose ends lie outside passes through the cone where it comes nearest to it, if at all: a
// line that leaves the cone at one end only has that end inside.
bool edge_meets(Cone cone, vec3 a, vec3 b) {
    vec3 edge = b - a;
    float a_along = dot(a, cone.axis), edge_along = dot(edge, cone.axis);
    vec3 a_off = a - a_along * cone.axis, edge_off = edge - edge_along * cone.axis;
    float square = cone.slope * cone.slope;
    float curve = dot(edge_off, edge_off) - square * edge_along * edge_along;
    float at = -(dot(a_off, edge_off) - square * a_along * edge_along) / curve;
    return curve > 0.0 && at > 0.0 && at < 1.0 && in_cone(cone, a + at * edge);
}

// Whether the ellipse that the triangle's plane cuts from the cone lies within it: its axis passes through.
bool holds_axis(vec3 a, vec3 b, vec3 c, vec3 axis) {
    vec3 met = meet_plane(vec3(0.0), axis, Triangle(a, b, c));
    return met.z > 0.0 && met.x >= 0.0 && met.y >= 0.0 && met.x + met.y <= 1.0;
}

bool may_show(vec3 a, vec3 b, vec3 c, vec3 normal, vec4 sphere) {
    vec3 towards = sphere.xyz - eye;
    towards -= 2.0 * dot(normal, sphere.xyz - eye - a) * normal;  // the virtual image of the centre
    float rest = dot(towards, towards) - sphere.w * sphere.w;
    if (rest <= 0.0) return true;  // the eye is in the sphere
    Cone cone = Cone(normalize(towards), sphere.w * inversesqrt(rest));
    return in_cone(cone, a) || in_cone(cone, b) || in_cone(cone, c)
        || edge_meets(cone, a, b) || edge_meets(cone, b, c) || edge_meets(cone, c, a)
        || holds_axis(a, b, c, cone.axis);
}

void main() {
    int index = int(gl_FragCoord.x) + 4096 * (int(gl_FragCoord.y) - first_row);
    int triangle = index / region_words, word = index % region_words;
    if (triangle >= triangles) discard;
    mat4x3 outward = object_to_world(reflector);
    Triangle t = triangle_at(first_triangle + triangle);
    vec3 a = outward * vec4(t.a, 1.0) - eye, b = outward * vec4(t.b, 1.0) - eye, c = outward * vec4(t.c, 1.0) - eye;
    vec3 normal = cross(b - a, c - a);
    float area = length(normal);
    mask = 0u;
    if (area == 0.0) return;
    for (int bit = 0; bit < 32; ++bit) {
        int object = 32 * word + bit;
        if (object >= objects) return;
        vec4 sphere = texelFetch(spheres, texel_at(object), 0);
        if (object == reflector || sphere.w < 0.0) continue;
        if (orthographic || may_show(a, b, c, normal / area, sphere)) mask |= 1u << bit;
    }
}
