// Light straight from the lamps, with shadows, and from the world, without: a preview. Results are what
// a white surface sends out: irradiance over pi.

#include "common/surface.glsl"
#include "common/tracer.glsl"
#include "common/world.glsl"

uniform int first_lamp;
uniform int lamp_count;
uniform vec3 world_light_sh[9];  // the world's irradiance over pi, in real spherical harmonics

const int SUN = 0, POINT = 1, SPOT = 2, AREA = 3;

struct Lamp {
    int kind;
    vec3 position, axis, color;
    float cone, blend;
};

// 3 texels a lamp: position, kind | axis, cosine of the cone | colour, cosine inside the blend.
Lamp lamp_at(int index) {
    int record = first_lamp + 3 * index;
    vec4 place = texelFetch(records, texel_at(record), 0), axis = texelFetch(records, texel_at(record + 1), 0);
    vec4 color = texelFetch(records, texel_at(record + 2), 0);
    return Lamp(int(place.w), place.xyz, axis.xyz, color.rgb, axis.w, color.w);
}

// Blender's units: a sun's colour is W/m², the others' is W, spread over the sphere (point, spot) or
// over the half space by Lambert's law (area).
vec3 irradiance_from(Lamp lamp, vec3 towards, float distance) {
    if (lamp.kind == SUN) return lamp.color;
    float falloff = 1.0 / (4.0 * PI * distance * distance);
    float along = -dot(towards, lamp.axis);
    if (lamp.kind == AREA) return lamp.color * 4.0 * falloff * max(along, 0.0);
    if (lamp.kind == SPOT) falloff *= smoothstep(0.0, 1.0, (along - lamp.cone) / max(lamp.blend - lamp.cone, 1e-6));
    return lamp.color * falloff;
}

vec3 lamp_light(Surface s) {
    vec3 sum = vec3(0.0);
    for (int i = 0; i < lamp_count; ++i) {
        Lamp lamp = lamp_at(i);
        vec3 to_lamp = lamp.kind == SUN ? -lamp.axis * 1e6 : lamp.position - s.position;
        float distance = length(to_lamp);
        vec3 towards = to_lamp / distance;
        float cosine = dot(s.normal, towards);
        if (cosine <= 0.0 || dot(s.flat_normal, towards) <= 0.0) continue;
        if (nearest_hit(Ray(s.position, towards), s.at, distance).instance != NONE) continue;
        sum += irradiance_from(lamp, towards, distance) * cosine / PI;
    }
    return sum;
}

// Ramamoorthi and Hanrahan 2001: nine coefficients hold a diffuse surface's view of the world.
vec3 world_light(vec3 n) {
    float basis[9] = float[9](0.282095, 0.488603 * n.y, 0.488603 * n.z, 0.488603 * n.x, 1.092548 * n.x * n.y,
                              1.092548 * n.y * n.z, 0.315392 * (3.0 * n.z * n.z - 1.0), 1.092548 * n.x * n.z,
                              0.546274 * (n.x * n.x - n.y * n.y));
    vec3 sum = vec3(0.0);
    for (int i = 0; i < 9; ++i) sum += basis[i] * world_light_sh[i];
    return max(sum, vec3(0.0));
}
