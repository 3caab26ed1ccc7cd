// A unit vector as an integer that a float holds exactly: its place on an octahedron, to a thousandth of a radian.

const float STEPS = 2047.0;

float packed_normal(vec3 n) {
    vec2 flat_place = n.xy / (abs(n.x) + abs(n.y) + abs(n.z));
    vec2 side = vec2(n.x >= 0.0 ? 1.0 : -1.0, n.y >= 0.0 ? 1.0 : -1.0);
    if (n.z < 0.0) flat_place = (1.0 - abs(flat_place.yx)) * side;
    vec2 step = round((0.5 + 0.5 * flat_place) * STEPS);
    return step.x + (STEPS + 1.0) * step.y;
}

vec3 unpacked_normal(float whole) {
    float row = floor(whole / (STEPS + 1.0));
    vec2 place = 2.0 * vec2(whole - (STEPS + 1.0) * row, row) / STEPS - 1.0;
    vec3 n = vec3(place, 1.0 - abs(place.x) - abs(place.y));
    float folded = max(-n.z, 0.0);
    n.xy += vec2(n.x >= 0.0 ? -folded : folded, n.y >= 0.0 ? -folded : folded);
    return normalize(n);
}
