// A unit vector as a point of a square (Meyer et al. 2010): the sphere on an octahedron, unfolded.

vec2 folded(vec2 p) {
    return (1.0 - abs(p.yx)) * mix(vec2(-1.0), vec2(1.0), greaterThanEqual(p, vec2(0.0)));
}

vec2 octahedral(vec3 v) {
    vec2 p = v.xy / (abs(v.x) + abs(v.y) + abs(v.z));
    return v.z < 0.0 ? folded(p) : p;
}

vec3 from_octahedral(vec2 p) {
    float z = 1.0 - abs(p.x) - abs(p.y);
    return normalize(vec3(z < 0.0 ? folded(p) : p, z));
}
