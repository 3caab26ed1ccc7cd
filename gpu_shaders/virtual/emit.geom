// The image of a triangle as a rectangle that surely holds it: along its longest side, with a margin.

#include "virtual/screen.glsl"
#include "virtual/results.glsl"

layout(triangles) in;
layout(triangle_strip, max_vertices = 4) out;

uniform isampler2D sources;  // triangle and instance that each is a piece of
uniform int left_out;        // an instance that is not seen by this path
uniform vec4 bounds;         // pixels that the path is seen in: low and high corner
uniform int first_triangle;
uniform float margin;        // pixels

const float MOST_LEAN = 1e-2;  // tangent, at a reflection point that was found

in vec4 found[];
in vec3 vertex[];
in vec4 shown_there[];

out vec2 corner;
flat out ivec2 shown;

void emit(vec2 pixel, ivec2 source) {
    corner = 2.0 * pixel / screen;
    shown = source;
    EmitVertex();
}

void rectangle(vec2 origin, vec2 along, vec2 low, vec2 high) {
    vec2 across = vec2(-along.y, along.x);
    vec2 a = origin + low.x * along + low.y * across, b = origin + high.x * along + low.y * across;
    vec2 c = origin + low.x * along + high.y * across, d = origin + high.x * along + high.y * across;
    vec2 least = min(min(a, b), min(c, d)) + 0.5 * screen, most = max(max(a, b), max(c, d)) + 0.5 * screen;
    if (any(greaterThan(least, bounds.zw)) || any(lessThan(most, bounds.xy))) return;
    ivec2 source = texelFetch(sources, texel_at(first_triangle + gl_PrimitiveIDIn), 0).xy;
    if (source.y == left_out) return;
    emit(a, source);
    emit(b, source);
    emit(c, source);
    emit(d, source);
}

// The rectangle around three places on the screen, with room for their edges to bend.
void hold(vec3 direction[3], vec4 place[3]) {
    vec3 w = vec3(place[0].z, place[1].z, place[2].z);
    if (all(lessThanEqual(w, vec3(0.0)))) return;
    if (any(lessThanEqual(w, vec3(0.0)))) {
        rectangle(vec2(0.0), vec2(1.0, 0.0), -0.5 * screen, 0.5 * screen);
        return;
    }
    vec2 a = place[0].xy, b = place[1].xy, c = place[2].xy;
    vec3 sides = vec3(distance(a, b), distance(b, c), distance(c, a));
    float longest = max(max(sides.x, sides.y), sides.z);
    vec2 from = longest == sides.x ? a : longest == sides.y ? b : c;
    vec2 to = longest == sides.x ? b : longest == sides.y ? c : a;
    vec2 other = longest == sides.x ? c : longest == sides.y ? a : b;
    vec2 along = longest > 1e-6 ? (to - from) / longest : vec2(1.0, 0.0);
    float height = dot(other - from, vec2(-along.y, along.x));
    float bent = max(max(bend(direction[0], direction[1], a, b), bend(direction[1], direction[2], b, c)),
                     bend(direction[2], direction[0], c, a));
    float around = margin + bent;
    rectangle(from, along, vec2(0.0, min(height, 0.0)) - around, vec2(longest, max(height, 0.0)) + around);
}

bool is_found(vec4 result) {
    return result.w >= 0.0 && result.w <= MOST_LEAN;
}

void main() {
    int beside = is_found(found[0]) ? 0 : is_found(found[1]) ? 1 : is_found(found[2]) ? 2 : -1;
    if (beside < 0) return;
    vec3 direction[3];
    vec4 place[3];
    for (int i = 0; i < 3; ++i) {
        direction[i] = found[i].xyz;
        place[i] = shown_there[i];
        // A corner that was not found, or behind the reflector, is looked for beside another.
        if (!is_found(found[i]) && !(is_whole(0) && found[i].w < 1e30)) {
            direction[i] = search(found[beside].xyz, vertex[i]).xyz;
            place[i] = shown_at(direction[i]);
        }
    }
    hold(direction, place);
}
