// The nearest triangle of the virtual meshes, where its reflector is seen.

uniform sampler2D ray_origins;     // the point of the reflector that a pixel shows; w: its part
uniform sampler2D ray_directions;  // and where its mirrored ray goes
uniform float part;
uniform vec4 eye;                  // w 0: infinitely far away, in that direction

in vec2 barycentric;
in vec3 mirrored;                  // what is seen here, in the world
flat in ivec2 source;              // triangle, instance
flat in int straddles;

out uvec4 seen;                    // instance + 1, triangle, barycentrics of the second and third corner

// Whether something is below the tangent plane of the reflector: then its image would be before it.
bool is_hidden(vec3 point, vec3 mirror, vec3 direction) {
    return dot(direction + normalize(eye.xyz - eye.w * mirror), point - mirror) < 0.0;
}

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    vec4 origin = texelFetch(ray_origins, pixel, 0);
    if (origin.w != part) discard;
    if (straddles != 0 && is_hidden(mirrored, origin.xyz, texelFetch(ray_directions, pixel, 0).xyz)) discard;
    seen = uvec4(source.y + 1, source.x, floatBitsToUint(barycentric));
}
