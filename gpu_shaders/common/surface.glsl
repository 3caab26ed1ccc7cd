// A point on a surface with everything that shading needs.

#include "common/image.glsl"

const int FRESNEL_CONSTANT = 0, FRESNEL_SCHLICK = 1, FRESNEL_DIELECTRIC = 2;
const int TINTED = 8;  // flag of a colour

struct Surface {
    Hit at;
    vec3 position;
    vec3 normal;      // shading normal, on the viewer's side
    vec3 flat_normal; // of the triangle, on the viewer's side
    vec3 base, emission, reflection;
    float diffuse;    // weight of scattering
    bool emits, reflects;
    int fresnel;
    float ior;
    int lightmap;
    vec2 lightmap_uv;
};

uniform int first_material;

// 5 texels a material (addon/drawing/tables.py).
vec4 material_texel(int material, int offset) {
    return texelFetch(records, texel_at(first_material + 5 * material + offset), 0);
}

// A program is compiled for what the scene's materials use (addon/drawing/resident.py): BASE_IMAGES,
// EMISSION_IMAGES and REFLECTION_IMAGES are 0, BYTES, FLOATS or both, VERTEX_COLORS 0 or 1.

// `flags` packs interpolation, extension and whether vertex colours count (addon/drawing/tables.py).
vec3 color_of(vec3 factor, float image, float flags, vec2 uv, vec3 vertex_color, int holds) {
    int bits = int(flags);
    if (holds != 0 && image >= 0.0) factor *= image_at(int(image), uv, bits & 1, (bits >> 1) & 3, holds).rgb;
    return (bits & TINTED) != 0 ? factor * vertex_color : factor;
}

// Cycles lifts a reflected ray that an interpolated normal would send under the true surface: the
// normal turns towards the flat one until the ray clears it. In the plane of both normals, a normal
// at angle a from the flat one reflects `view` (at angle b, length r there) to the height
// r cos(2 a - b) above the surface, so the largest angle allowed has a closed form.
vec3 normal_that_reflects(vec3 normal, vec3 flat_normal, vec3 view) {
    float height = dot(view, flat_normal);
    float least = min(0.9 * height, 0.01);
    vec3 mirrored = 2.0 * dot(normal, view) * normal - view;
    vec3 across = normal - dot(normal, flat_normal) * flat_normal;
    if (dot(mirrored, flat_normal) >= least || dot(across, across) < 1e-12) return normal;
    across = normalize(across);
    float side = dot(view, across);
    float angle = 0.5 * (atan(side, height) + acos(clamp(least / length(vec2(side, height)), -1.0, 1.0)));
    return cos(angle) * flat_normal + sin(angle) * across;
}

vec3 vertex_color_at(int triangle, vec3 weight) {
    vec3 sum = vec3(0.0);
    for (int i = 0; i < 3; ++i) sum += weight[i] * texelFetch(vertex_colors, texel_at(3 * triangle + i), 0).rgb;
    return sum;
}

Surface surface_at(Hit hit, vec3 direction) {
    Surface s;
    s.at = hit;
    Triangle t = triangle_at(hit.triangle);
    vec3 weight = vec3(1.0 - hit.barycentric.x - hit.barycentric.y, hit.barycentric);
    vec4 data[6];
    for (int i = 0; i < 6; ++i) data[i] = texelFetch(corners, texel_at(6 * hit.triangle + i), 0);

    s.position = object_to_world(hit.instance) * vec4(mat3(t.a, t.b, t.c) * weight, 1.0);
    mat3 to_normal = transpose(mat3(world_to_object(hit.instance)));
    s.flat_normal = normalize(to_normal * cross(t.b - t.a, t.c - t.a));
    s.normal = normalize(to_normal * (mat3(data[0].xyz, data[2].xyz, data[4].xyz) * weight));
    if (dot(s.flat_normal, direction) > 0.0) {
        s.flat_normal = -s.flat_normal;
        s.normal = -s.normal;
    }
    s.normal = normal_that_reflects(s.normal, s.flat_normal, -direction);

    vec2 uv = mat3x2(data[0].w, data[1].x, data[2].w, data[3].x, data[4].w, data[5].x) * weight;
    s.lightmap = lightmap_of(hit.instance);
    s.lightmap_uv = mat3x2(data[1].yz, data[3].yz, data[5].yz) * weight;

    int material = first_material_of(hit.instance) + slot_of(hit.triangle);
    vec4 base = material_texel(material, 0), emission = material_texel(material, 1);
    vec4 reflection = material_texel(material, 2), sources = material_texel(material, 3);
    vec4 flags = material_texel(material, 4);
    vec3 tint = VERTEX_COLORS != 0 ? vertex_color_at(hit.triangle, weight) : vec3(1.0);
    s.base = color_of(base.rgb, sources.x, flags.x, uv, tint, BASE_IMAGES);
    s.emission = color_of(emission.rgb, sources.y, flags.y, uv, tint, EMISSION_IMAGES);
    s.reflection = color_of(reflection.rgb, sources.z, flags.z, uv, tint, REFLECTION_IMAGES);
    s.diffuse = base.a;
    s.emits = emission.a > 0.0;
    s.fresnel = int(reflection.a);
    s.ior = flags.w;
    s.reflects = is_reflector(hit.instance) && sources.w > 0.0;
    return s;
}

// Unpolarised reflectance of a dielectric (Fresnel), for light arriving from outside.
float dielectric(float cosine, float ior) {
    float g = sqrt(max(0.0, ior * ior - 1.0 + cosine * cosine));
    float a = (g - cosine) / (g + cosine);
    float b = (cosine * (g + cosine) - 1.0) / (cosine * (g - cosine) + 1.0);
    return 0.5 * a * a * (1.0 + b * b);
}

vec3 reflectance(Surface s, vec3 direction) {
    if (!s.reflects) return vec3(0.0);
    float cosine = clamp(-dot(s.normal, direction), 0.0, 1.0);
    if (s.fresnel == FRESNEL_SCHLICK) return mix(s.reflection, vec3(1.0), pow(1.0 - cosine, 5.0));
    if (s.fresnel == FRESNEL_DIELECTRIC) return s.reflection * dielectric(cosine, s.ior);
    return s.reflection;
}
