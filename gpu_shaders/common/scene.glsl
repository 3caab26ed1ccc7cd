// The scene's tables (addon/drawing/tables.py) and what a ray meets in it.

#include "common/data.glsl"

uniform sampler2D positions;       // 3 texels a triangle: corner xyz; w of the first: material slot
uniform sampler2D corners;         // 6 texels a triangle: 3 normals; 3 uvs and 3 lightmap uvs, two a texel
uniform sampler2D vertex_colors;   // 3 texels a triangle: linear RGBA
uniform sampler2D records;         // instances (10 texels each), then materials, hierarchy and lamps
uniform usampler2D images;         // 1 texel an image: offset, width, height, flags

const int NONE = -1;

struct Ray {
    vec3 origin;
    vec3 direction;  // unit length, so that distances are metres
};

// A point on a triangle of an instance. `instance` is NONE where the ray leaves the scene.
struct Hit {
    int instance;
    int triangle;
    vec2 barycentric;  // weights of the second and third corner
    float distance;    // metres
};

struct Triangle {
    vec3 a, b, c;
};

Triangle triangle_at(int triangle) {
    return Triangle(texelFetch(positions, texel_at(3 * triangle), 0).xyz,
                    texelFetch(positions, texel_at(3 * triangle + 1), 0).xyz,
                    texelFetch(positions, texel_at(3 * triangle + 2), 0).xyz);
}

int slot_of(int triangle) {
    return int(texelFetch(positions, texel_at(3 * triangle), 0).w);
}

vec4 instance_texel(int instance, int offset) {
    return texelFetch(records, texel_at(10 * instance + offset), 0);
}

// Affine maps are stored as three rows.
mat4x3 object_to_world(int instance) {
    return transpose(mat3x4(instance_texel(instance, 0), instance_texel(instance, 1), instance_texel(instance, 2)));
}

mat4x3 world_to_object(int instance) {
    return transpose(mat3x4(instance_texel(instance, 3), instance_texel(instance, 4), instance_texel(instance, 5)));
}

int first_material_of(int instance) {
    return int(instance_texel(instance, 6).x);
}

int mesh_of(int instance) {
    return int(instance_texel(instance, 9).x);
}

bool is_reflector(int instance) {
    return instance_texel(instance, 6).y > 0.0;
}

// Whose pass draws its reflections (addon/drawing/resident.py); NONE for what is no reflector.
int group_of(int instance) {
    return int(instance_texel(instance, 6).y) - 1;
}

// Counts the reflectors of its group, in the order of their instances.
int reflector_of(int instance) {
    return int(instance_texel(instance, 6).w);
}

int lightmap_of(int instance) {
    return int(instance_texel(instance, 6).z);
}

// Intersection of a ray with a triangle's plane (Möller and Trumbore 1997): barycentrics and distance.
vec3 meet_plane(vec3 origin, vec3 direction, Triangle t) {
    vec3 ab = t.b - t.a, ac = t.c - t.a, to_origin = origin - t.a;
    vec3 p = cross(direction, ac), q = cross(to_origin, ab);
    float inverse = 1.0 / dot(ab, p);
    return inverse * vec3(dot(to_origin, p), dot(direction, q), dot(ac, q));
}

// The same for a ray in the world and a triangle of an instance.
vec3 meet_plane_of(int instance, int triangle, Ray ray) {
    mat4x3 inward = world_to_object(instance);
    return meet_plane(inward * vec4(ray.origin, 1.0), mat3(inward) * ray.direction, triangle_at(triangle));
}
