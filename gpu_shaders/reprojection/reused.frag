// What the mirrored rays of this picture meet, found among what those of the key frame did.
//
// The hit is kept and not its colour: the ray of this pixel meets the key frame's triangles itself, so that what it
// brings back is exact. Where the key frame cannot vouch for the hit, the pixel is left to be traced.

#include "reprojection/kept.glsl"
#include "reprojection/buffers.glsl"
#include "reprojection/walk.glsl"

uniform int steps;   // of the search, at most
uniform int checks;  // places on the way to a hit that are held against the key frame, at most
#if MOVED > 0
uniform int moved[MOVED];  // instances that the key frame shows elsewhere
#endif

const float LONGEST_STEP = 32.0, ARRIVED = 1.0, NEAR_BY = 2.0;  // pixels
const float ON_SURFACE = 1e-3, BEFORE = 0.95, BEHIND = 1.02;      // shares of a distance

// By how much a pixel to the side moves the place that a mirrored ray has after `reach` metres; FAR: its direction.
bool moves_by(ivec2 pixel, ivec2 side, Sample here, float reach, out vec3 moves) {
    Sample next = known_sample(pixel + side);
    float forward = 1.0;
    if (next.reflector != here.reflector) {
        next = known_sample(pixel - side);
        forward = -1.0;
    }
    moves = next.direction - here.direction;
    if (reach < FAR) moves = next.origin - here.origin + reach * moves;
    moves *= forward;
    return next.reflector == here.reflector;
}

vec3 without(vec3 v, vec3 axis) {
    return v - dot(v, axis) * axis;
}

// Pixels from `pixel` to the one whose mirrored ray comes by where ours is after `distance` metres: the reflector's
// curvature, in the differences between neighbours (Igehy 1999), says how fast its image moves.
bool way_to(ivec2 pixel, Sample here, Ray ray, float distance, out vec2 way) {
    vec3 a, b, miss = ray.direction - here.direction;
    if (distance < FAR) miss = ray.origin - here.origin + distance * miss;
    if (!moves_by(pixel, ivec2(1, 0), here, distance, a) || !moves_by(pixel, ivec2(0, 1), here, distance, b))
        return false;
    a = without(a, here.direction);
    b = without(b, here.direction);
    float aa = dot(a, a), ab = dot(a, b), bb = dot(b, b), determinant = aa * bb - ab * ab;
    way = vec2(bb * dot(a, miss) - ab * dot(b, miss), aa * dot(b, miss) - ab * dot(a, miss)) / determinant;
    return determinant > 1e-6 * aa * bb;
}

// Newton's method: the pixel of the earlier picture whose mirrored ray met what ours does.
bool search(int reflector, Ray ray, vec2 start, out vec2 place, out float distance) {
    place = start;
    for (int i = 0; i < steps; ++i) {
        ivec2 pixel = ivec2(floor(place + 0.5));
        Sample here = known_sample(pixel);
        if (here.reflector != reflector) return false;
        // Our ray comes by what that one met: as far as that is from where ours begins, along it.
        distance = here.reach;
        if (here.reach < FAR)
            distance = max(dot(here.origin + here.reach * here.direction - ray.origin, ray.direction), 0.0);
        vec2 way;
        if (!way_to(pixel, here, ray, distance, way)) return false;
        place = vec2(pixel) + way * min(1.0, LONGEST_STEP / length(way));
        if (all(lessThanEqual(abs(way), vec2(ARRIVED)))) return true;
    }
    return false;
}

// What the rays of a pixel of the key frame met; which: 0 the mirrored ones, 1 those that were mirrored twice.
uvec2 name_at(ivec2 pixel, int which) {
    uvec4 met = is_in_picture(pixel) ? texelFetch(known_met, pixel, 0) : uvec4(0u);
    return which == 0 ? met.xy : met.zw;
}

// The nearest that `ray` meets of what is named by the four pixels around `place`, and whether that is sure: not where
// these are of more objects than one behind another.
bool meet_around(vec2 place, int which, Ray ray, Hit from, out Hit hit, inout bool passed) {
    hit = Hit(NONE, NONE, vec2(0.0), FAR);
    ivec2 corner = ivec2(floor(place)), nearest = ivec2(floor(place + 0.5)), other = 2 * corner + 1 - nearest;
    uvec2 middle = name_at(nearest, which), before = uvec2(0u);
    uint second = middle.x;
    for (int i = 0; i < 4; ++i) {
        ivec2 pixel = ivec2((i & 1) == 0 ? nearest.x : other.x, (i & 2) == 0 ? nearest.y : other.y);
        uvec2 name = i == 0 ? middle : name_at(pixel, which);
        if (name.x != middle.x) {
            if (second != middle.x && second != name.x) return false;
            second = name.x;
        }
        if ((name.y & DOUBTFUL) != 0u) return false;
        if (name.x == 0u || name.x == WORLD_MET || name == before) continue;
        before = name;
        if (!walk_to(ray, from, int(name.x) - 1, int(name.y), hit, passed)) return false;
    }
    return hit.instance != NONE || middle.x == WORLD_MET;
}

// Metres along a mirrored ray of the earlier picture to where ours comes closest to it; `apart`: how far off it is.
float crossing_of(Sample here, Ray ray, out float apart) {
    vec3 across = cross(here.direction, ray.direction), between = ray.origin - here.origin;
    float squared = dot(across, across);
    apart = abs(dot(between, across)) * inversesqrt(squared);
    return dot(cross(between, ray.direction), across) / squared;
}

// The next of `count` places on the way whose mirrored ray is shorter than `distance`, from number `i` on. The others
// hide nothing of our ray, and lanes that have found theirs wait (see common/layers.glsl).
int next_short(int i, int count, vec2 start, vec2 way, float distance) {
    bool is_short = false;
    while (i <= count && !is_short) {
        ivec2 pixel = ivec2(floor(start + way * float(i) / float(count + 1) + 0.5));
        uvec4 texel = texelFetch(known_geometry, pixel, 0);
        is_short = texel.w == 0u || uintBitsToFloat(texel.z) < distance;
        if (!is_short) ++i;
    }
    return i;
}

// Whether the earlier picture saw what is on the way to a hit. Its pixels from `start`, where our ray begins, to
// `place`, where it ends, show the way as straight as the mirror is flat; else Newton's method leads back to it. Where
// a point of the way was hidden, behind what is seen there, something may stand that no ray has met (the pillar of
// Xie et al., figure 9). What our ray meets of what is seen is the hit, and `place` then where.
bool is_seen(Hit from, Ray ray, vec2 start, inout vec2 place, inout Hit hit, inout bool passed) {
    vec2 way = place - start, aside;
    int count = min(checks, int(max(abs(way.x), abs(way.y))));
    for (int i = next_short(1, count, start, way, hit.distance); i <= count;
         i = next_short(i + 1, count, start, way, hit.distance)) {
        ivec2 pixel = ivec2(floor(start + way * float(i) / float(count + 1) + 0.5));
        Sample here = known_sample(pixel);
        if (here.reflector != from.instance) return false;
        float apart, crossing = crossing_of(here, ray, apart);
        if (apart > pixel_size() * (here.depth + crossing) && crossing > 0.0
            && way_to(pixel, here, ray, crossing, aside)) {
            pixel = ivec2(floor(vec2(pixel) + clamp(aside, -LONGEST_STEP, LONGEST_STEP) + 0.5));
            here = known_sample(pixel);
            if (here.reflector != from.instance) return false;
            crossing = crossing_of(here, ray, apart);
        }
        if (crossing < BEFORE * here.reach) continue;
        uvec2 name = name_at(pixel, 0);
        bool hidden = crossing > BEHIND * here.reach;
        if (name.x == WORLD_MET || !hidden && int(name.x) - 1 == hit.instance) continue;
        float before = hit.distance;
        if ((name.y & DOUBTFUL) != 0u) return false;
        if (!walk_to(ray, from, int(name.x) - 1, int(name.y), hit, passed)) return false;
        if (hit.distance < before) {
            place = vec2(pixel);
            return true;
        }
        if (hidden) return false;
    }
    return true;
}

// Whether our ray may meet, before `distance` metres, what the key frame shows elsewhere.
bool meets_moved(Ray ray, float distance) {
#if MOVED > 0
    for (int i = 0; i < MOVED; ++i) {
        mat4x3 inward = world_to_object(moved[i]);
        vec3 low = instance_texel(moved[i], 7).xyz, size = instance_texel(moved[i], 8).xyz;
        vec3 inverse = safe_inverse(mat3(inward) * ray.direction);
        vec2 span = box_span(inward * vec4(ray.origin, 1.0), inverse, low, low + size);
        if (span.x <= span.y && span.y >= 0.0 && span.x <= distance) return true;
    }
#endif
    return false;
}

// Whether the mirrored ray at `place` comes by where ours is after `distance` metres.
bool comes_by(vec2 place, Ray ray, float distance) {
    ivec2 pixel = ivec2(floor(place + 0.5));
    vec2 way;
    return way_to(pixel, known_sample(pixel), ray, distance, way) && all(lessThanEqual(abs(way), vec2(NEAR_BY)));
}

// What the mirrored ray of a surface meets. Returns 0, or why that is not known.
float reused_hit(Surface s, Ray ray, out Hit hit, out vec2 place, inout bool passed) {
    vec2 start = known_pixel(s.position);
    Sample here = known_sample(ivec2(floor(start + 0.5)));
    if (here.reflector != s.at.instance) return UNSEEN;
    if (abs(dot(here.normal, s.position - here.origin)) > ON_SURFACE * here.depth) return UNSEEN;
    float expected;
    if (!search(here.reflector, ray, start, place, expected)) return UNSEEN;
    if (!meet_around(place, 0, ray, s.at, hit, passed)) return UNSURE;
    bool is_expected = abs(hit.distance - expected) < (1.0 - BEFORE) * expected;
    if (!is_expected && !comes_by(place, ray, hit.distance)) return UNSURE;
    if (!is_seen(s.at, ray, start, place, hit, passed)) return UNSEEN;
    return meets_moved(ray, hit.distance) ? UNSEEN : 0.0;
}

// The whole path. Returns 0, or why not all of it is known: AGAIN where it is mirrored once more, which takes so much
// more code that those pixels are gathered for it.
float reused_path(Surface s, vec3 direction, out Path path, inout bool passed) {
    Ray ray = mirrored_ray(s, direction);
    vec2 place;
    path.goes_on = false;
    float reason = reused_hit(s, ray, path.first, place, passed);
    if (reason < 0.0) return reason;
    if (path.first.instance == NONE) {
        path.light = world_radiance(ray.direction);
        return 0.0;
    }
    Surface at = surface_at(path.first, ray.direction);
    path.light = own_radiance(at, ray.direction);
    path.goes_on = at.reflects && reflections > 1;
    if (!path.goes_on) return 0.0;
#if LISTED
    Ray again = mirrored_ray(at, ray.direction);
    if (!meet_around(place, 1, again, path.first, path.second, passed) || passed) return UNSURE;
    if (meets_moved(again, path.second.distance)) return UNSURE;
    path.light += reflectance(at, ray.direction) * light_at(path.second, again.direction, reflections - 2);
    return 0.0;
#else
    return AGAIN;
#endif
}

void main() {
    ivec2 pixel = asked();
    Ray ray = pixel_ray(pixel);
    Hit hit = pixel_hit(ray, pixel);
    if (hit.instance == NONE || !is_reflector(hit.instance)) discard;
    Surface s = surface_at(hit, ray.direction);
    if (!s.reflects) discard;
    Path path;
    bool passed = false;
    float reason = reused_path(s, ray.direction, path, passed);
    if (reason < 0.0) keep_nothing(reason);
    else keep(s, ray.direction, path, !passed);
}
