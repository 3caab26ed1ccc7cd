// What a pixel keeps of its mirrored ray: the reflection buffers (Xie et al., 3.1), one pixel of them.
//
// LISTED is 1 for a pass over pixels that were gathered, one beside the other, so that no lane waits for a pixel
// that is not asked for.

#include "reprojection/light.glsl"
#include "reprojection/met.glsl"
#include "reprojection/octahedron.glsl"

#if LISTED
uniform usampler2D listed;  // the pixels, row by row; how many in all is `count`
uniform int count;
#endif

layout(location = 0) out uvec4 geometry;  // normal; bits of metres from the camera, and to what is met; instance + 1
layout(location = 1) out vec4 light;      // radiance that arrives there; metres that it came, below 0 where missing
layout(location = 2) out uvec4 met;       // (instance + 1, triangle) there; and of what is mirrored there once more

const float AGAIN = -1.0, UNSEEN = -2.0, UNSURE = -3.0;  // why light is missing

// The pixel that is asked for.
ivec2 asked() {
    ivec2 place = ivec2(gl_FragCoord.xy) - corner;
#if LISTED
    if (place.x + place.y * textureSize(listed, 0).x >= count) discard;
    place = ivec2(texelFetch(listed, place, 0).xy);
#endif
    return place;
}

uvec2 name_of(Hit hit) {
    return hit.instance == NONE ? uvec2(WORLD_MET, 0u) : uvec2(hit.instance + 1, hit.triangle);
}

// `sure`: whether what was met may be taken over once more.
void keep(Surface s, vec3 direction, Path path, bool sure) {
    geometry = uvec4(packUnorm2x16(0.5 + 0.5 * octahedral(mirror_normal(s, direction))), floatBitsToUint(s.at.distance),
                     floatBitsToUint(path.first.distance), s.at.instance + 1);
    light = vec4(path.light, path.first.distance);
    met = uvec4(name_of(path.first), path.goes_on ? name_of(path.second) : uvec2(0u));
    if (!sure) met.y |= DOUBTFUL;
}

void keep_nothing(float reason) {
    geometry = uvec4(0u);
    light = vec4(0.0, 0.0, 0.0, reason);
    met = uvec4(0u);
}
