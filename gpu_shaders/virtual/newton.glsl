// The reflection points of a vertex by Newton's method: where the path from the eye to it is stationary (Fermat).

#include "virtual/maps.glsl"

const int SAMPLES = 16;           // as addon/methods/virtual/bundles.py has it

uniform vec4 eye;                 // w 0: infinitely far away, in that direction
uniform int steps;
uniform mat3 world_to_ball[ORDER];  // takes a whole part to what is about a ball of radius 1
uniform mat3 ball_to_part[ORDER];
uniform vec3 sample_origins[SAMPLES];     // of rays that take the path: where they leave it
uniform vec3 sample_directions[SAMPLES];  // and which way they go
uniform vec3 sample_starts[SAMPLES * ORDER];  // where they are reflected, as directions of the parts' frames

// Of the tangent that a face reaches to. In a patch a search begins where a ray comes by, so that it has not far to go.
const float LONGEST_STEP = 0.7, LONGEST_IN_PATCH = 0.5;
const float DONE = 1e-6;
const float BACK = 1e30;          // the error of a point that faces away from the eye
const float GRAZING = 0.05;       // sine of both ways' heights above the surface, added
// What is so little below the surface, as a sine, counts as above: floats hold the surface to 1e-7 of its size, and the
// root of twice that is what they tell of what just touches it.
const float LEVEL = 5e-4;
const int HALVINGS = 12;

// The bisector of the ways from a point to where the path comes from and goes on.
struct Bisector {
    vec3 normal;
    vec4 to_from, to_next;       // unit length, and the inverse of the length: 0 for infinitely far away
    float side_from, side_next;  // of the surface that they are on
    float lean;                  // off the normal, as a tangent
    float nearness;              // the inverses of both lengths, added
    vec3 off;                    // along the surface, over nearness: about how far the point is from its place
    vec3 across;                 // unit, along the surface, from way to way where both graze it; 0 where they do not
    float heights;               // of both ways, added, over how far they go apart
};

vec4 way_to(vec4 to, vec3 from) {
    vec3 way = to.xyz - to.w * from;
    float inverse = inversesqrt(max(dot(way, way), 1e-30));
    return vec4(way * inverse, to.w * inverse);
}

// How a way turns when its beginning moves.
vec3 turned(vec4 way, vec3 along) {
    return -way.w * (along - dot(along, way.xyz) * way.xyz);
}

vec3 flattened(vec3 v, vec3 normal) {
    return v - dot(v, normal) * normal;
}

// A vertex behind the surface would be mirrored to its front (Estalella et al., 6.1): that changes the bisector along
// the normal only, so that `off` is the same.
Bisector bisector_at(Point p, vec4 from, vec4 next) {
    Bisector b;
    b.normal = p.normal * inversesqrt(max(dot(p.normal, p.normal), 1e-30));
    b.to_from = way_to(from, p.position);
    b.to_next = way_to(next, p.position);
    float height_from = dot(b.to_from.xyz, b.normal), height_next = dot(b.to_next.xyz, b.normal);
    b.side_from = height_from < -LEVEL ? -1.0 : 1.0;
    b.side_next = height_next < -LEVEL ? -1.0 : 1.0;
    b.nearness = max(b.to_from.w + b.to_next.w, 1e-30);
    vec3 off = flattened(b.to_from.xyz + b.to_next.xyz, b.normal);
    // Where both ways graze the surface their sum is a difference of cosines, which has no digits left: heights have.
    vec3 apart = flattened(b.to_from.xyz - b.to_next.xyz, b.normal);
    float inverse = inversesqrt(max(dot(apart, apart), 1e-30));
    float heights = abs(height_from) + abs(height_next);
    b.heights = heights * inverse;
    b.across = b.heights < GRAZING ? apart * inverse : vec3(0.0);
    float higher = b.side_next * height_next - b.side_from * height_from;
    off += b.across * (higher * b.heights - dot(off, b.across));
    b.lean = length(off) / max(heights, 1e-9);
    b.off = off / b.nearness;
    return b;
}

// How `off` changes when the ways and the normal turn, and the ways' inverse lengths grow. Where both ways graze the
// surface it counts across how their heights change: that brings them level, however far they are aside.
vec3 change(Bisector b, vec3 turn_from, vec3 turn_next, float nearer, vec3 normal_turn) {
    vec3 sum = b.to_from.xyz + b.to_next.xyz;
    vec3 changed = flattened(turn_from + turn_next, b.normal) - dot(sum, b.normal) * normal_turn;
    vec3 apart = b.side_next * b.to_next.xyz - b.side_from * b.to_from.xyz;
    float rising = dot(b.side_next * turn_next - b.side_from * turn_from, b.normal) + dot(apart, normal_turn);
    changed += b.across * (rising * b.heights - dot(changed, b.across));
    return (changed - b.off * nearer) / b.nearness;
}

// How the inverse of a way's length grows when its beginning moves.
float nearing(vec4 way, vec3 along) {
    return way.w * way.w * dot(along, way.xyz);
}

// When the point itself moves along its surface.
vec3 change_here(Point p, Bisector b, vec3 along, vec3 normal_along) {
    vec3 normal_turn = flattened(normal_along, b.normal) * inversesqrt(max(dot(p.normal, p.normal), 1e-30));
    float nearer = nearing(b.to_from, along) + nearing(b.to_next, along);
    return change(b, turned(b.to_from, along), turned(b.to_next, along), nearer, normal_turn);
}

// When where the path comes from moves.
vec3 change_from(Bisector b, vec3 along) {
    return change(b, -turned(b.to_from, along), vec3(0.0), -nearing(b.to_from, along), vec3(0.0));
}

// When where it goes on to moves.
vec3 change_next(Bisector b, vec3 along) {
    return change(b, vec3(0.0), -turned(b.to_next, along), -nearing(b.to_next, along), vec3(0.0));
}

// Two vectors along the surface as the surface's own directions see them.
mat2 seen_along(Point p, vec3 by_u, vec3 by_v) {
    return mat2(dot(p.along_u, by_u), dot(p.along_v, by_u), dot(p.along_u, by_v), dot(p.along_v, by_v));
}

vec2 seen_along(Point p, vec3 v) {
    return vec2(dot(p.along_u, v), dot(p.along_v, v));
}

mat2 inverse_of(mat2 m) {
    float d = determinant(m);
    return abs(d) > 1e-30 ? mat2(m[1][1], -m[0][1], -m[1][0], m[0][0]) / d : mat2(0.0);
}

bool is_whole(int part) {
    return part_maps[part].z != 1;
}

vec2 shortened(vec2 step, int part) {
    float longest = (is_whole(part) ? LONGEST_STEP : LONGEST_IN_PATCH) * part_reaches[part], size = length(step);
    return size > longest ? step * (longest / size) : step;
}

Place moved(int part, Place from, vec2 step) {
    Place to = Place(from.face, from.at + step);
    return is_whole(part) ? place_of(part, direction_of(to)) : to;
}

// Which way the bisector leans at an angle from the eye, on a sphere of radius 1; `to_vertex` in the plane of eye and
// vertex. Times what is above 0 there, since the lean itself is a difference of cosines where both ways graze.
float sphere_lean(float angle, vec4 to_eye, vec2 to_vertex) {
    vec2 normal = vec2(cos(angle), sin(angle)), along = vec2(-normal.y, normal.x);
    vec2 eye_way = normalize(to_eye.xy - to_eye.w * normal), vertex_way = normalize(to_vertex - normal);
    float eye_height = dot(eye_way, normal), vertex_height = dot(vertex_way, normal);
    return (eye_height + vertex_height) * (eye_height * dot(vertex_way, along) + vertex_height * dot(eye_way, along));
}

// Where the search on a whole body begins: where a ball would reflect the vertex (Alhazen), between the point nearest
// to the eye and the horizon. Straight lines and what touches stay so where an ellipsoid becomes that ball.
vec3 first_guess(int part, vec4 from, vec3 vertex) {
    vec3 centre = part_to_world[part][3].xyz;
    vec3 out_there = world_to_ball[part] * (vertex - centre);
    vec4 to_eye = way_to(vec4(world_to_ball[part] * (from.xyz - from.w * centre), from.w), vec3(0.0));
    float away = dot(out_there, to_eye.xyz);
    vec3 aside = out_there - away * to_eye.xyz;
    float off = length(aside);
    aside = off > 0.0 ? aside / off : vec3(0.0);
    float inverse = min(to_eye.w, 1.0);
    vec4 eye_there = to_eye.w > 0.0 ? vec4(1.0 / inverse, 0.0, 0.0, 1.0) : vec4(1.0, 0.0, 0.0, 0.0);
    float low = 0.0, high = min(atan(off, away), acos(inverse));
    for (int i = 0; i < HALVINGS; ++i) {
        float middle = 0.5 * (low + high);
        if (sphere_lean(middle, eye_there, vec2(away, off)) > 0.0) low = middle;
        else high = middle;
    }
    float angle = 0.5 * (low + high);
    return normalize(ball_to_part[part] * (cos(angle) * to_eye.xyz + sin(angle) * aside));
}

// The ray among the samples that comes nearest to a vertex, by angle, of those that begin away from a direction of
// the first part's frame, by at least so much of a face.
int nearest_sample(vec3 vertex, vec3 away_from, float least) {
    int nearest = 0;
    float most = -2.0;
    for (int i = 0; i < SAMPLES; ++i) {
        float cosine = dot(normalize(vertex - sample_origins[i]), sample_directions[i]);
        if (cosine > most && distance(sample_starts[i], away_from) >= least) {
            most = cosine;
            nearest = i;
        }
    }
    return nearest;
}

int nearest_sample(vec3 vertex) {
    return nearest_sample(vertex, vec3(0.0), 0.0);
}

#if ORDER == 1
// xyz: direction of the reflection point in the part's frame, w: how the bisector leans there, below 0 where the
// vertex lies behind the reflector.
vec4 search(vec3 start, vec3 vertex) {
    Place best = place_of(0, start);
    vec2 step = vec2(0.0);
    mat3x2 to_step = mat3x2(0.0);
    float least = BACK, lean = BACK;
    for (int i = 0; i <= steps; ++i) {
        Place now = moved(0, best, step);
        Point p = point_at(0, now);
        Bisector b = bisector_at(p, eye, vec4(vertex, 1.0));
        bool back = is_whole(0) && b.side_from < 0.0;
        // How far off: on a convex body, the next step as the last one was found (Deuflhard, *Newton methods for
        // nonlinear problems*, 2004, 3.3), since `off` itself is all noise from aside along the horizon. Patches have
        // inflections, where steps tell nothing.
        float far = is_whole(0) ? length(to_step * b.off) : length(b.off);
        if (i == 0 || !back && far < least) {
            best = now;
            lean = b.side_from * b.side_next * b.lean;
            mat2 pp = seen_along(p, change_here(p, b, p.along_u, p.normal_u), change_here(p, b, p.along_v, p.normal_v));
            to_step = -inverse_of(pp) * transpose(mat2x3(p.along_u, p.along_v));
            step = to_step * b.off;
            least = back ? BACK : is_whole(0) ? length(step) : length(b.off);
            step = shortened(step, 0);
        } else {
            step *= 0.5;
        }
        if (dot(step, step) < DONE * DONE) break;
    }
    return vec4(direction_of(best), lean);
}

vec4 search(vec3 vertex) {
    return search(is_whole(0) ? first_guess(0, eye, vertex) : sample_starts[nearest_sample(vertex)], vertex);
}
#else
// The same for two reflections: both points move in one step. The direction is that of the first.
vec4 search(vec3 start, vec3 vertex) {
    Place best_1 = place_of(0, start), best_2 = place_of(1, sample_starts[SAMPLES + nearest_sample(vertex)]);
    vec2 step_1 = vec2(0.0), step_2 = vec2(0.0);
    float least = 2.0 * BACK, lean = BACK;
    for (int i = 0; i <= steps; ++i) {
        Place now_1 = moved(0, best_1, step_1), now_2 = moved(1, best_2, step_2);
        Point p = point_at(0, now_1), q = point_at(1, now_2);
        Bisector a = bisector_at(p, eye, vec4(q.position, 1.0));
        Bisector b = bisector_at(q, vec4(p.position, 1.0), vec4(vertex, 1.0));
        bool back = (is_whole(0) && a.side_from < 0.0) || (is_whole(1) && b.side_from < 0.0);
        float off = back ? BACK : length(vec2(length(a.off), length(b.off)));
        if (off < least) {
            least = off;
            best_1 = now_1;
            best_2 = now_2;
            lean = min(a.side_from * a.side_next, b.side_from * b.side_next) * max(a.lean, b.lean);
            mat2 pp = seen_along(p, change_here(p, a, p.along_u, p.normal_u), change_here(p, a, p.along_v, p.normal_v));
            mat2 pq = seen_along(p, change_next(a, q.along_u), change_next(a, q.along_v));
            mat2 qp = seen_along(q, change_from(b, p.along_u), change_from(b, p.along_v));
            mat2 qq = seen_along(q, change_here(q, b, q.along_u, q.normal_u), change_here(q, b, q.along_v, q.normal_v));
            vec2 off_1 = seen_along(p, a.off), off_2 = seen_along(q, b.off);
            mat2 without = inverse_of(pp);
            step_2 = -inverse_of(qq - qp * without * pq) * (off_2 - qp * without * off_1);
            step_1 = -without * (off_1 + pq * step_2);
            step_1 = shortened(step_1, 0);
            step_2 = shortened(step_2, 1);
        } else {
            step_1 *= 0.5;
            step_2 *= 0.5;
        }
        if (dot(step_1, step_1) + dot(step_2, step_2) < DONE * DONE) break;
    }
    return vec4(direction_of(best_1), lean);
}

vec4 search(vec3 vertex) {
    return search(sample_starts[nearest_sample(vertex)], vertex);
}
#endif
