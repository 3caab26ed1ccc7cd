// A point on a surface with everything that shading needs.

#include "common/image.glsl"

const int MIRRORS_NOTHING = -1, FRESNEL_CONSTANT = 0, FRESNEL_SCHLICK = 1, FRESNEL_DIELECTRIC = 2;
const int TINTED = 8;  // flag of a colour
const vec3 LUMINANCE = vec3(0.2126, 0.7152, 0.0722);

struct Surface {
    Hit at;
    vec3 position;
    vec3 normal;      // shading normal, on the viewer's side
    vec3 flat_normal; // of the triangle, on the viewer's side
    vec3 base, emission, reflection;
    float diffuse;    // weight of scattering
    bool emits, reflects;
    float roughness;  // Blender's
    bool multiscatter; // whether light between facets counts
    int fresnel;
    float ior;
    int lightmap;
    vec2 lightmap_uv;
};

uniform int first_material;

// 6 texels a material (addon/drawing/tables.py).
vec4 material_texel(int material, int offset) {
    return texelFetch(records, texel_at(first_material + 6 * material + offset), 0);
}

// A program is compiled for what the scene's materials use (addon/drawing/resident.py): BASE_IMAGES,
// EMISSION_IMAGES, REFLECTION_IMAGES and ROUGHNESS_IMAGES are 0, BYTES, FLOATS or both; VERTEX_COLORS,
// EMISSION and DIELECTRICS (among what mirrors) 0 or 1.

// `flags` packs interpolation, extension and whether vertex colours count (addon/drawing/tables.py).
vec3 color_of(vec3 factor, float image, float flags, vec2 uv, vec3 vertex_color, int holds) {
    if (holds == 0 && VERTEX_COLORS == 0) return factor;
    int bits = int(flags);
    if (holds != 0 && image >= 0.0) factor *= image_at(int(image), uv, bits & 1, (bits >> 1) & 3, holds).rgb;
    return VERTEX_COLORS != 0 && (bits & TINTED) != 0 ? factor * vertex_color : factor;
}

vec3 vertex_color_at(int triangle, vec3 weight) {
    vec3 sum = vec3(0.0);
    for (int i = 0; i < 3; ++i) sum += weight[i] * texelFetch(vertex_colors, texel_at(3 * triangle + i), 0).rgb;
    return sum;
}

vec4 corner_texel(int triangle, int offset) {
    return texelFetch(corners, texel_at(6 * triangle + offset), 0);
}

Surface surface_at(Hit hit, vec3 direction) {
    Surface s;
    s.at = hit;
    Triangle t = triangle_at(hit.triangle);
    vec3 weight = vec3(1.0 - hit.barycentric.x - hit.barycentric.y, hit.barycentric);

    s.position = object_to_world(hit.instance) * vec4(mat3(t.a, t.b, t.c) * weight, 1.0);
    mat3 to_normal = transpose(mat3(world_to_object(hit.instance)));
    s.flat_normal = normalize(to_normal * cross(t.b - t.a, t.c - t.a));
    mat3 normals = mat3(corner_texel(hit.triangle, 0).xyz, corner_texel(hit.triangle, 1).xyz,
                        corner_texel(hit.triangle, 2).xyz);
    s.normal = normalize(to_normal * (normals * weight));
    if (dot(s.flat_normal, direction) > 0.0) {
        s.flat_normal = -s.flat_normal;
        s.normal = -s.normal;
    }

    vec4 first = corner_texel(hit.triangle, 3), second = corner_texel(hit.triangle, 4);
    vec4 third = corner_texel(hit.triangle, 5);
    vec2 uv = mat3x2(first.xy, first.zw, second.xy) * weight;
    s.lightmap = lightmap_of(hit.instance);
    s.lightmap_uv = mat3x2(second.zw, third.xy, third.zw) * weight;

    int material = first_material_of(hit.instance) + slot_of(hit.triangle);
    // What a pass does not use is not fetched: the first two texels are what every pass uses.
    vec4 base = material_texel(material, 0), kind = material_texel(material, 1);
    vec4 reflection = material_texel(material, 2), emission = material_texel(material, 3);
    vec4 flags = material_texel(material, 4), gloss = material_texel(material, 5);
    vec3 tint = VERTEX_COLORS != 0 ? vertex_color_at(hit.triangle, weight) : vec3(1.0);
    s.base = color_of(base.rgb, kind.x, kind.y, uv, tint, BASE_IMAGES);
    s.emits = EMISSION != 0 && any(greaterThan(emission.rgb, vec3(0.0)));
    s.emission = s.emits ? color_of(emission.rgb, emission.a, flags.y, uv, tint, EMISSION_IMAGES) : vec3(0.0);
    s.reflection = color_of(reflection.rgb, reflection.a, flags.x, uv, tint, REFLECTION_IMAGES);
    s.roughness = dot(color_of(gloss.rgb, gloss.a, flags.z, uv, vec3(1.0), ROUGHNESS_IMAGES), LUMINANCE);
    s.multiscatter = flags.w > 0.0;
    s.diffuse = base.a;
    s.fresnel = int(kind.z);
    s.ior = kind.w;
    s.reflects = is_reflector(hit.instance) && s.fresnel != MIRRORS_NOTHING;
    return s;
}

// Unpolarised reflectance of a dielectric (Fresnel), for light arriving from outside.
float dielectric(float cosine, float ior) {
    float g = sqrt(max(0.0, ior * ior - 1.0 + cosine * cosine));
    float a = (g - cosine) / (g + cosine);
    float b = (cosine * (g + cosine) - 1.0) / (cosine * (g - cosine) + 1.0);
    return 0.5 * a * a * (1.0 + b * b);
}

// Cycles lifts a reflected ray that an interpolated normal would send under the true surface: the
// normal turns towards the flat one until the ray clears it. In the plane of both normals it then
// halves the angle between the way to the viewer and a ray of the same length at the least height allowed.
vec3 mirror_normal(Surface s, vec3 direction) {
    float height = -dot(direction, s.flat_normal);
    float least = min(0.9 * height, 0.01);
    vec3 across = s.normal - dot(s.normal, s.flat_normal) * s.flat_normal;
    if (dot(reflect(direction, s.normal), s.flat_normal) >= least || dot(across, across) < 1e-12) return s.normal;
    across = normalize(across);
    vec2 viewer = vec2(-dot(direction, across), height);
    vec2 half_way = normalize(viewer + vec2(sqrt(dot(viewer, viewer) - least * least), least));
    return half_way.x * across + half_way.y * s.flat_normal;
}

Ray mirrored_ray(Surface s, vec3 direction) {
    return Ray(s.position, reflect(direction, mirror_normal(s, direction)));
}

// `cosine` is that of the angle between the ray and the normal of the mirror, or of a facet of it.
vec3 reflectance_at(Surface s, float cosine) {
    if (!s.reflects) return vec3(0.0);
    if (s.fresnel == FRESNEL_SCHLICK) return mix(s.reflection, vec3(1.0), pow(1.0 - cosine, 5.0));
    if (DIELECTRICS != 0 && s.fresnel == FRESNEL_DIELECTRIC) return s.reflection * dielectric(cosine, s.ior);
    return s.reflection;
}

vec3 reflectance(Surface s, vec3 direction) {
    if (!s.reflects) return vec3(0.0);
    return reflectance_at(s, clamp(-dot(mirror_normal(s, direction), direction), 0.0, 1.0));
}
