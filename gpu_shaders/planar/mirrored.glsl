// The picture that the mirrored camera saw, at the same place of the screen.

uniform sampler2D mirrored;             // radiance, as large as the picture or smaller
uniform usampler2D mirrored_visibility; // of the same size
uniform bool filtered;                  // the mirrored picture is smaller than ours
uniform vec2 extent;                    // the part of it that our picture covers, around its middle

// 0..1 over the mirrored picture.
vec2 mirrored_place() {
    return 0.5 + extent * (gl_FragCoord.xy / vec2(textureSize(visibility, 0)) - 0.5);
}

vec3 mirrored_radiance() {
    return filtered ? texture(mirrored, mirrored_place()).rgb : texelFetch(mirrored, ivec2(gl_FragCoord.xy), 0).rgb;
}

// How far `ray` gets to the triangle that the mirrored picture shows here.
float mirrored_distance(Ray ray) {
    ivec2 place = ivec2(mirrored_place() * vec2(textureSize(mirrored_visibility, 0)));
    uvec2 seen = texelFetch(mirrored_visibility, place, 0).xy;
    if (seen.x == 0u) return FAR;
    return meet_plane_of(int(seen.x) - 1, int(seen.y), ray).z;
}
