// A rough flat mirror: rays of its GGX lobe, followed through the picture that the mirrored camera saw.

#include "common/reflection.glsl"
#include "common/ggx.glsl"
#include "planar/mirror.glsl"

uniform sampler2D mirrored;        // radiance
uniform sampler2D mirrored_depth;  // metres along the mirrored camera's axis; FAR for the world
uniform mat4 world_to_mirrored;    // clip space of the mirrored camera
uniform vec4 mirrored_axis;        // depth of a point: dot with (point, 1)
uniform float reach;               // metres: where an orthographic camera's rays are half way to infinity
uniform int rays;
uniform float pattern;             // 0..1, other for each sample of the pixel

const int STEPS = 16, HALVINGS = 5;
const float LAST = 0.9995;         // of the way to infinity, as the screen shows it
const float FRONT = 0.15;          // of a step: how deep behind a front a halved ray may be
const float GRAIN = 0.002;         // of the way from the eye: how uneven depth is within a texel

struct Way {
    vec4 from, along;  // clip space: a point on the way is at from + t along
    float depth, deepens;
    float reach;
};

// The way to infinity, cut so that it looks even on the screen: `part` 0..1 to metres.
float metres(Way way, float part) {
    return way.reach * part / (1.0 - part);
}

vec2 place_at(Way way, float t) {
    vec4 at = way.from + t * way.along;
    return clamp(0.5 + 0.5 * at.xy / at.w, 0.0, 1.0);
}

float depth_at(vec2 place) {
    ivec2 size = textureSize(mirrored_depth, 0);
    return texelFetch(mirrored_depth, min(ivec2(place * vec2(size)), size - 1), 0).x;
}

// How far along the way something as deep is.
float metres_to(Way way, float depth) {
    return depth < FAR ? (depth - way.depth) / max(way.deepens, 1e-6) : FAR;
}

// How far behind the surface that is seen there the ray is after `t` metres.
float behind(Way way, float t) {
    return way.depth + t * way.deepens - depth_at(place_at(way, t));
}

// Where between two distances the ray comes to be behind what is seen, and how deep it then is.
float crossing(Way way, float before, float after, out float deep) {
    deep = behind(way, after);
    for (int i = 0; i < HALVINGS; ++i) {
        float middle = 0.5 * (before + after), there = behind(way, middle);
        if (there < 0.0) {
            before = middle;
        } else {
            after = middle;
            deep = there;
        }
    }
    return after;
}

// Where on the mirrored picture the ray ends; `t` is how far away that is, FAR for the world. A ray that goes
// behind something without coming through its front, past a silhouette or out of an opening, goes on. One that is
// never seen to end shows what it last was seen before: a wall behind a column, or the sky behind a gate.
vec2 follow(Way way, float jitter, out float t) {
    float before = 0.0, open = 0.0;
    for (int i = 0; i < STEPS; ++i) {
        float part = (float(i) + jitter) / float(STEPS), at = metres(way, min(part * part, LAST)), deep;
        if (behind(way, at) < 0.0) {
            open = at;
        } else {
            t = crossing(way, before, at, deep);
            if (deep <= FRONT * (at - before) * abs(way.deepens) + GRAIN * way.depth) return place_at(way, t);
        }
        before = at;
    }
    vec2 place = place_at(way, open);
    t = metres_to(way, depth_at(place));
    return place;
}

Way way_of(Ray ray) {
    Way way;
    way.from = world_to_mirrored * vec4(ray.origin, 1.0);
    way.along = world_to_mirrored * vec4(ray.direction, 0.0);
    way.depth = dot(mirrored_axis, vec4(ray.origin, 1.0));
    way.deepens = dot(mirrored_axis.xyz, ray.direction);
    way.reach = orthographic ? reach : way.depth / max(way.deepens, 0.05);
    return way;
}

// Even over the pixels of a neighbourhood (Jimenez 2014) and over the rays of a pixel (Roberts 2018).
vec2 random(int index) {
    float turn = fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715)))) + pattern;
    return fract(vec2(turn, 0.618034 * turn) + float(index) * vec2(0.7548776662, 0.5698402910) + 0.5);
}

// What lies straight behind the mirror is at the pixel's own place, within the margin.
Mirrored perfect(Surface s, vec3 direction) {
    ivec2 place = ivec2(gl_FragCoord.xy) + (textureSize(mirrored, 0) - textureSize(visibility, 0)) / 2;
    Ray ray = mirrored_ray(s, direction);
    vec3 radiance = reflectance(s, direction) * texelFetch(mirrored, place, 0).rgb;
    return Mirrored(radiance, metres_to(way_of(ray), texelFetch(mirrored_depth, place, 0).x));
}

Mirrored mirrored_light(Surface s, vec3 direction) {
    if (!shows_mirror(s.at.instance, s.at.triangle)) discard;
    float alpha = alpha_of(s), nearest = FAR;
    if (alpha < SHARP) return perfect(s, direction);
    mat3 frame = frame_of(s.normal);
    vec3 view = -direction * frame, sum = vec3(0.0), mirrored_share = vec3(0.0);
    for (int i = 0; i < rays; ++i) {
        vec2 u = random(i);
        vec3 facet = sample_half(view, alpha, u), light = reflect(-view, facet);
        if (light.z <= 0.0) continue;
        Ray ray = Ray(s.position, frame * light);
        float t;
        vec2 place = follow(way_of(ray), fract(u.x + 0.381966 * float(i)), t);
        vec3 kept = reflectance_at(s, clamp(dot(view, facet), 0.0, 1.0)) * passed_on(view, light, alpha);
        sum += kept * (t < FAR ? texture(mirrored, place).rgb : world_radiance(ray.direction));
        mirrored_share += kept;
        if (i == 0) nearest = t;
    }
    vec3 radiance = sum / float(rays);
    // What lies under a dielectric was lit as if this were smooth, which mirrors more at grazing angles.
    if (DIELECTRICS != 0 && s.fresnel == FRESNEL_DIELECTRIC)
        radiance += (reflectance(s, direction) - mirrored_share / float(rays)) * scattered(s);
    return Mirrored(radiance, nearest);
}
