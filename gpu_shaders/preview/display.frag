// From the radiance of one or two pictures to what a screen shows: as addon/metrics/display.py, with an exposure.

uniform sampler2D left_picture;
uniform sampler2D right_picture;
uniform vec2 shown_size;  // of the target, in pixels
uniform float split;      // where the right picture begins, in pixels; beyond the target for the left one alone
uniform float line;       // half the width of the line between the two, in pixels
uniform float gain;       // radiance that is shown as white is 1 / gain
uniform bool by_table;    // a view transform of Blender's (batch/preview/views.py), else the plain sRGB curve
uniform sampler3D table;  // by red, green and blue, each at even stops
uniform vec2 stops;       // of the table's first and last entries

out vec4 shown;

// IEC 61966-2-1.
vec3 encoded(vec3 linear) {
    vec3 clamped = clamp(linear, 0.0, 1.0);
    return mix(1.055 * pow(clamped, vec3(1.0 / 2.4)) - 0.055, 12.92 * clamped, lessThanEqual(clamped, vec3(0.0031308)));
}

vec3 looked_up(vec3 linear) {
    vec3 at = (log2(max(linear, vec3(1e-30))) - stops.x) / (stops.y - stops.x);
    float side = float(textureSize(table, 0).x);
    return texture(table, (0.5 + (side - 1.0) * clamp(at, 0.0, 1.0)) / side).rgb;
}

void main() {
    vec2 place = gl_FragCoord.xy / shown_size;
    bool is_left = gl_FragCoord.x < split;
    vec3 radiance = is_left ? texture(left_picture, place).rgb : texture(right_picture, place).rgb;
    bool on_line = abs(gl_FragCoord.x - split) < line;
    vec3 color = by_table ? looked_up(gain * radiance) : encoded(gain * radiance);
    shown = vec4(on_line ? vec3(1.0) : color, 1.0);
}
