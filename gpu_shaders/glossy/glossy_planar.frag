// A rough flat mirror: rays of its GGX lobe, followed through the picture that the mirrored camera saw.

#include "common/rough.glsl"
#include "planar/mirror.glsl"

uniform sampler2D mirrored;        // radiance
uniform sampler2D mirrored_depth;  // metres along the mirrored camera's axis; FAR for the world
uniform sampler2D even_ranges;     // depth, nearest and farthest around (addon/methods/glossy/depth_ranges.py)
uniform sampler2D odd_ranges;
uniform int levels;                // the last
uniform mat4 world_to_mirrored;    // clip space of the mirrored camera
uniform vec4 mirrored_axis;        // depth of a point: dot with (point, 1)
uniform float reach;               // metres: where an orthographic camera's rays are half way to infinity
uniform float focus;               // texels to a metre, a metre away; an orthographic camera's anywhere

const int MOST_STEPS = 8, HALVINGS = 4, NARROWINGS = 3;
const float FINEST = 1.0;          // texels: what is nearer together is not told apart
const float LAST = 0.9995;         // of the way to infinity, as the screen shows it
const float FRONT = 0.15;          // of a step: how deep behind a front a halved ray may be
const float GRAIN = 0.002;         // of the way from the eye: how uneven depth is within a texel
const float EVEN = 0.4;            // a mean is of what is this much as far away as what the ray meets, or 1 / this

// ---- The way of a ray over the mirrored picture

struct Way {
    vec4 from, along;  // clip space: a point on the way is at from + t along
    float depth, deepens;
    float reach;
};

// The way to infinity, cut so that it looks even on the screen: `part` 0..1 to metres, and back.
float metres(Way way, float part) {
    return way.reach * part / (1.0 - part);
}

float part_at(Way way, float t) {
    return max(t, 0.0) / (max(t, 0.0) + way.reach);
}

vec2 place_at(Way way, float t) {
    vec4 at = way.from + t * way.along;
    return clamp(0.5 + 0.5 * at.xy / at.w, 0.0, 1.0);
}

ivec2 texel_of(vec2 place) {
    ivec2 size = textureSize(mirrored_depth, 0);
    return min(ivec2(place * vec2(size)), size - 1);
}

float depth_at(vec2 place) {
    return texelFetch(mirrored_depth, texel_of(place), 0).x;
}

// How far along the way something as deep is.
float metres_to(Way way, float depth) {
    return depth < FAR ? (depth - way.depth) / max(way.deepens, 1e-6) : FAR;
}

// How far behind the surface that is seen there the ray is after `t` metres.
float behind(Way way, float t) {
    return way.depth + t * way.deepens - depth_at(place_at(way, t));
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

// ---- Where it ends

// Metres to the nearest and to the farthest that is seen around a place, `level` 1 or more.
vec2 range_at(Way way, vec2 place, int level) {
    ivec2 size = textureSize(mirrored_depth, 0) >> level;
    ivec2 texel = ivec2(size.x, 0) + min(texel_of(place) >> level, size - 1);
    vec2 range = (level & 1) == 0 ? texelFetch(even_ranges, texel, 0).xy : texelFetch(odd_ranges, texel, 0).xy;
    return vec2(metres_to(way, range.x), metres_to(way, range.y));
}

// How many texels the way crosses between two of its parts.
float texels(Way way, vec2 span) {
    vec2 crossed = abs(place_at(way, metres(way, span.y)) - place_at(way, metres(way, span.x)));
    return max(crossed.x * float(textureSize(mirrored, 0).x), crossed.y * float(textureSize(mirrored, 0).y));
}

// The parts of the way between which it must end: everything around it is nearer or farther.
vec2 narrowed(Way way, out float across) {
    vec2 span = vec2(0.0, LAST);
    across = texels(way, span);
    for (int i = 0; i < NARROWINGS && across > FINEST; ++i) {
        int level = int(ceil(log2(across + 1.0)));
        if (level > levels) return span;
        vec2 range = range_at(way, place_at(way, metres(way, span.x)), level);
        span.x = clamp(part_at(way, range.x), span.x, LAST);
        span.y = clamp(part_at(way, range.y), span.x, span.y);
        across = texels(way, span);
    }
    return span;
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
    float across;
    vec2 span = narrowed(way, across);
    float before = metres(way, span.x), open = before;
    if (across > FINEST) {
        float steps = min(ceil(across / FINEST), float(MOST_STEPS));
        for (float i = jitter; i < steps + float(span.y < LAST); i += 1.0) {
            float part = min(i / steps, 1.0), at = metres(way, mix(span.x, span.y, part * part)), deep;
            if (behind(way, at) < 0.0) {
                open = at;
            } else {
                t = crossing(way, before, at, deep);
                if (deep <= FRONT * (at - before) * abs(way.deepens) + GRAIN * way.depth) return place_at(way, t);
            }
            before = at;
        }
    }
    vec2 place = place_at(way, open);
    t = metres_to(way, depth_at(place));
    return place;
}

// ---- What is there

// The mean of what a ray that stands for many sees: its cone is `width` wide, a metre away. Where the cone holds
// a silhouette it narrows, since what lies behind and before would mix.
vec3 radiance_at(Way way, vec2 place, float t, float width) {
    float level = log2(max(width * t * focus / (way.from.w + t * way.along.w), 1.0));
    for (level = min(level, float(levels)); level > 0.0; level -= 2.0) {
        vec2 range = range_at(way, place, int(ceil(level)));
        if (range.x >= EVEN * t && EVEN * range.y <= t) break;
    }
    return textureLod(mirrored, place, level).rgb;
}

bool is_shown(Surface s) {
    return shows_mirror(s.at.instance, s.at.triangle);
}

bool may_send(uvec2 seen) {
    return shows_mirror(int(seen.x) - 1, int(seen.y));
}

// What lies straight behind the mirror is at the pixel's own place, within the margin.
Mirrored sharp_light(Surface s, vec3 direction) {
    ivec2 place = ivec2(gl_FragCoord.xy) + (textureSize(mirrored, 0) - textureSize(visibility, 0)) / 2;
    Ray ray = mirrored_ray(s, direction);
    vec3 radiance = reflectance(s, direction) * texelFetch(mirrored, place, 0).rgb;
    return Mirrored(radiance, metres_to(way_of(ray), texelFetch(mirrored_depth, place, 0).x));
}

Mirrored light_along(Surface s, Lobe lobe, Facet facet, int number, int count) {
    // What the ray stands for in the middle of the lobe, across the plane of incidence, where no lobe is stretched.
    float narrowest = 2.0 * sqrt(0.5 * TAU / float(count)) * lobe.alpha * lobe.view.z;
    Way way = way_of(Ray(s.position, facet.direction));
    float t;
    vec2 place = follow(way, fract(facet.drawn.x + 0.381966 * float(number)), t);
    if (t >= FAR) return Mirrored(world_radiance(facet.direction), FAR);
    return Mirrored(radiance_at(way, place, t, narrowest / (1.0 - facet.drawn.y)), t);
}
