// From a triangle near to where a ray meets a surface to the one that it meets.

uniform isampler2D neighbours;  // 1 texel a triangle: what lies across the edge from each corner to the next

const int BORDER = -1, LONGEST_WALK = 48, LONGEST_WAY_PAST = 8;

// Walks from `triangle` across the edges that the ray lies beyond. Takes the triangle that it meets for `hit`, if that
// is nearer. Where the surface ends or turns away before, the ray has `passed` it. False where neither can be told.
bool walk_to(Ray ray, Hit from, int instance, int triangle, inout Hit hit, inout bool passed) {
    mat4x3 inward = world_to_object(instance);
    vec3 origin = inward * vec4(ray.origin, 1.0), direction = mat3(inward) * ray.direction;
    float facing = 0.0;
    for (int i = 0; i < LONGEST_WALK; ++i) {
        Triangle t = triangle_at(triangle);
        float side = dot(cross(t.b - t.a, t.c - t.a), direction);
        if (i == 0) facing = side;
        if (side * facing <= 0.0) return passed = i > 0 && i <= LONGEST_WAY_PAST;
        vec3 met = meet_plane(origin, direction, t);
        vec3 weight = vec3(1.0 - met.x - met.y, met.xy);
        float least = min(min(weight.x, weight.y), weight.z);
        if (least >= -1e-6) {
            if (met.z < 1e-5 * (1.0 + length(ray.origin)) || instance == from.instance && triangle == from.triangle)
                return false;
            if (met.z < hit.distance) hit = Hit(instance, triangle, met.xy, met.z);
            return true;
        }
        ivec3 across = texelFetch(neighbours, texel_at(triangle), 0).xyz;
        triangle = least == weight.x ? across.y : least == weight.y ? across.z : across.x;
        if (triangle < 0) return passed = triangle == BORDER && i < LONGEST_WAY_PAST;
    }
    return false;
}
