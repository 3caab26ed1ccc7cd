// The reflection buffers of an earlier picture, pixel by pixel (Xie et al., 3.1; kept.glsl).

#include "reprojection/octahedron.glsl"

uniform usampler2D known_geometry;
uniform usampler2D known_met;
uniform mat4 known_camera_to_world;
uniform vec4 known_window;
uniform bool known_orthographic;
uniform mat4 known_world_to_clip;

// A mirrored ray of that picture.
struct Sample {
    int reflector;   // instance, NONE where the pixel shows none
    vec3 origin;     // on the reflector
    vec3 normal;
    vec3 direction;
    float reach;     // metres to what it met; FAR for the world
    float depth;     // metres from the camera to the reflector
};

bool is_in_picture(ivec2 pixel) {
    return all(greaterThanEqual(pixel, ivec2(0))) && all(lessThan(pixel, textureSize(known_geometry, 0)));
}

// Where its camera saw a point, in pixels: whole numbers are the middles of pixels.
vec2 known_pixel(vec3 point) {
    vec4 clip = known_world_to_clip * vec4(point, 1.0);
    return clip.w > 0.0 ? (0.5 * clip.xy / clip.w + 0.5) * vec2(textureSize(known_geometry, 0)) - 0.5 : vec2(-1e6);
}

// The width of a pixel a metre before the camera.
float pixel_size() {
    return (known_window.y - known_window.x) / float(textureSize(known_geometry, 0).x);
}

Sample known_sample(ivec2 pixel) {
    uvec4 texel = is_in_picture(pixel) ? texelFetch(known_geometry, pixel, 0) : uvec4(0u);
    vec2 place = (vec2(pixel) + 0.5) / vec2(textureSize(known_geometry, 0));
    Ray eye = ray_through(place, known_window, known_orthographic, known_camera_to_world);
    vec3 normal = from_octahedral(2.0 * unpackUnorm2x16(texel.x) - 1.0);
    float depth = uintBitsToFloat(texel.y);
    return Sample(int(texel.w) - 1, eye.origin + depth * eye.direction, normal, reflect(eye.direction, normal),
                  uintBitsToFloat(texel.z), depth);
}
