// Images as Cycles reads them: texel centres at halves, bytes interpolated as stored, sRGB decoded after.

#include "common/scene.glsl"

uniform sampler2D byte_texels;
uniform sampler2D float_texels;

const int IMAGE_BYTES = 1, IMAGE_SRGB = 2;  // flags of an image
const int BYTES = 1, FLOATS = 2;             // what an image may hold, where the program knows
const int LINEAR = 0, CLOSEST = 1;
const int REPEAT = 0, EXTEND = 1, CLIP = 2, MIRROR = 3;

float decode_srgb(float encoded) {
    return encoded <= 0.04045 ? encoded / 12.92 : pow((encoded + 0.055) / 1.055, 2.4);
}

// GLSL leaves % of a negative number open.
int modulo(int i, int size) {
    return i - size * int(floor(float(i) / float(size)));
}

int wrap(int i, int size, int extension) {
    if (extension == REPEAT) return modulo(i, size);
    if (extension == MIRROR) {
        int j = modulo(i, 2 * size);
        return j < size ? j : 2 * size - 1 - j;
    }
    return clamp(i, 0, size - 1);
}

// `holds` is BYTES, FLOATS or both; a constant, so that a program fetches only what its scene has.
vec4 image_texel(uvec4 image, int x, int y, int extension, int holds) {
    ivec2 size = ivec2(image.yz);
    if (extension == CLIP && (x < 0 || y < 0 || x >= size.x || y >= size.y)) return vec4(0.0);
    ivec2 place = texel_at(int(image.x) + wrap(x, size.x, extension) + size.x * wrap(y, size.y, extension));
    if (holds == FLOATS || (holds != BYTES && (int(image.w) & IMAGE_BYTES) == 0))
        return texelFetch(float_texels, place, 0);
    return texelFetch(byte_texels, place, 0);
}

vec4 image_at(int index, vec2 uv, int interpolation, int extension, int holds) {
    uvec4 image = texelFetch(images, texel_at(index), 0);
    vec2 place = uv * vec2(image.yz);
    vec4 value;
    if (interpolation == CLOSEST) {
        ivec2 i = ivec2(floor(place));
        value = image_texel(image, i.x, i.y, extension, holds);
    } else {
        ivec2 i = ivec2(floor(place - 0.5)), j = i + 1;
        vec2 f = place - 0.5 - vec2(i);
        vec4 below = mix(image_texel(image, i.x, i.y, extension, holds),
                         image_texel(image, j.x, i.y, extension, holds), f.x);
        vec4 above = mix(image_texel(image, i.x, j.y, extension, holds),
                         image_texel(image, j.x, j.y, extension, holds), f.x);
        value = mix(below, above, f.y);
    }
    if (holds != FLOATS && (int(image.w) & IMAGE_SRGB) != 0)
        value.rgb = vec3(decode_srgb(value.r), decode_srgb(value.g), decode_srgb(value.b));
    return value;
}
