// The reflection buffers of a key frame (pack.frag), pixel by pixel, and what of them may be joined.

#include "common/camera.glsl"
#include "reprojection/octahedron.glsl"

uniform sampler2D known_geometry;
uniform sampler2D known_light;
uniform mat4 known_camera_to_world;
uniform vec4 known_window;
uniform bool known_orthographic;
uniform float cut;  // share of a depth from which on the next one is another surface's

const int INVALID = -32768;  // of an offset
const float FARTHEST = 6e4;  // metres; what is beyond counts as there, so that it can be interpolated

// The sampling geometry of a pixel (Xie et al., 3.2).
struct Known {
    vec3 position, normal, direction;  // `direction` from the camera
    float depth;     // metres from there; 0: the world
    float specular;  // 0: no mirror
};

bool is_known(ivec2 pixel) {
    return all(greaterThanEqual(pixel, ivec2(0))) && all(lessThan(pixel, textureSize(known_geometry, 0)));
}

float depth_at(ivec2 pixel) {
    return is_known(pixel) ? texelFetch(known_geometry, pixel, 0).z : 0.0;
}

Known known_at(ivec2 pixel) {
    vec4 texel = texelFetch(known_geometry, pixel, 0);
    vec2 place = (vec2(pixel) + 0.5) / vec2(textureSize(known_geometry, 0));
    Ray eye = ray_through(place, known_window, known_orthographic, known_camera_to_world);
    return Known(eye.origin + texel.z * eye.direction, from_octahedral(texel.xy), eye.direction, texel.z, texel.w);
}

vec4 light_known_at(ivec2 pixel) {
    return texelFetch(known_light, pixel, 0);
}

// Whether two depths are of different surfaces; there is none of the world.
bool is_cut(float a, float b) {
    return a <= 0.0 || b <= 0.0 || abs(a - b) > cut * min(a, b);
}
