// The reflection point of a vertex as published: follow the projected bisector through the reflector's maps, by the
// midpoint method with a step of changing length (Estalella et al., 4.2, 4.3 and 6.1).

#include "virtual/newton.glsl"

uniform float threshold;    // of the error function (1)

const float BEST_CHANGE = 0.5;  // of the field over half a step: where it is linear, no step comes nearer to its sink
const float TOO_FAR = 2.0;
const float MOST_GROWTH = 4.0;  // of the step's length
const float LOST = 1e-2;        // an error from which on there is no reflection point here: 11 degrees

// What the maps tell of a vertex at a point of the reflector.
struct Sight {
    vec3 position, normal;
    vec3 direction;    // B', from the end of the normal to the end of the bisector
    float error;       // E(P) of (1), 0 to 1
    bool hidden;       // the vertex is below the tangent plane there, and was mirrored to its front
    bool turned_away;  // the point faces away from the eye
};

Sight sight_at(Point p, vec3 vertex) {
    Sight s;
    s.position = p.position;
    s.normal = normalize(p.normal);
    vec3 to_eye = way_to(eye, p.position).xyz, to_vertex = way_to(vec4(vertex, 1.0), p.position).xyz;
    float height = dot(to_vertex, s.normal);
    s.hidden = height < 0.0;
    s.turned_away = dot(to_eye, s.normal) <= 0.0;
    vec3 sum = to_eye + to_vertex - 2.0 * min(height, 0.0) * s.normal;
    s.direction = sum * inversesqrt(max(dot(sum, sum), 1e-30)) - s.normal;
    s.error = 0.25 * dot(s.direction, s.direction);  // (1 - B · N) / 2 of unit vectors, without its cancellation
    return s;
}

// b_P: how a point of the cube map moves on the face across `axis` when the reflector's point moves along B',
// as far as if it were at distance 1 from the part's centre.
vec3 projected(vec3 direction, vec3 at, int axis) {
    vec3 move = direction * normal_to_world[0];
    move *= length(direction) * inversesqrt(max(dot(move, move), 1e-30));
    float ahead = at[axis];
    return length(at) * (move - at * (move[axis] / ahead));
}

// A direction as a point of the cube, or of a patch's face.
vec3 on_map(vec3 direction, int axis) {
    return direction / max(abs(direction[axis]), 1e-6);
}

int axis_of(vec3 direction) {
    return is_whole(0) ? largest_axis(direction) : 2;
}

// Where the bisector of the directions from the part's centre meets its map, or nearest to the eye if it faces away
// there; a patch is begun in its middle.
vec3 start_of(vec3 vertex) {
    if (!is_whole(0)) return vec3(0.0, 0.0, 1.0);
    vec3 centre = part_to_world[0][3].xyz;
    vec3 to_eye = way_to(eye, centre).xyz, to_vertex = way_to(vec4(vertex, 1.0), centre).xyz;
    vec3 middle = normalize((to_eye + to_vertex) * mat3(part_to_world[0]) + vec3(1e-9));
    bool turned_away = sight_at(point_at(0, place_of(0, middle)), vertex).turned_away;
    return turned_away ? normalize(to_eye * mat3(part_to_world[0])) : middle;
}

Sight follow(vec3 vertex) {
    vec3 at = start_of(vertex);
    float h = part_bends[0];  // the other way on a concave part, as its normals turn
    for (int i = 0; i < steps; ++i) {
        int axis = axis_of(at);
        at = on_map(at, axis);
        Sight here = sight_at(point_at(0, place_of(0, at)), vertex);
        if (here.error < threshold) return here;
        vec3 b = projected(here.direction, at, axis);
        float longest = LONGEST_STEP * part_reaches[0] / length(b);
        h = clamp(h, -longest, longest);
        vec3 half_way = at + 0.5 * h * b;
        Sight there = sight_at(point_at(0, place_of(0, half_way)), vertex);
        vec3 m = projected(there.direction, half_way, axis);
        float change = is_whole(0) && there.turned_away ? TOO_FAR : length(m - b) / length(b);
        // A step past the sink, or past the horizon of a whole body, is taken again, shorter.
        if (change < 1.0) at += h * m;
        h *= clamp(BEST_CHANGE / change, 1.0 / MOST_GROWTH, MOST_GROWTH);
    }
    return sight_at(point_at(0, place_of(0, at)), vertex);
}

bool is_lost(Sight s) {
    return s.turned_away || s.error > LOST;
}

// xyz: the virtual vertex, mirrored about the tangent plane; w: 0, or 1 where the vertex is hidden by the reflector, or
// 2 where the part does not reflect it, so that its place says nothing.
vec4 virtual_vertex(Sight s, vec3 vertex) {
    float height = dot(vertex - s.position, s.normal);
    return vec4(vertex - 2.0 * height * s.normal, is_lost(s) ? 2.0 : s.hidden ? 1.0 : 0.0);
}
