// The mirrored rays of a path (addon/methods/virtual/bundles.py).

uniform vec4 bundle;       // the ball that they begin in: centre, radius
uniform vec4 bundle_axis;  // where they go: axis, radians off it

// Whether one of them may meet a ball.
bool in_bundle(vec3 centre, float radius) {
    vec3 way = centre - bundle.xyz;
    float away = length(way), near = radius + bundle.w;
    if (away <= near) return true;
    float off = acos(clamp(dot(way, bundle_axis.xyz) / away, -1.0, 1.0));
    return off <= bundle_axis.w + asin(near / away);
}
