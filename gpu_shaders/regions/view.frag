// Debug view of the reflection regions: green for the share of objects that the pixel's triangle may
// show, red where it shows none.

#include "common/picture.glsl"
#include "regions/mask.glsl"

uniform float weight;
uniform int objects;

layout(location = 0) out vec4 color;  // alpha: whether any object is left

void main() {
    Hit hit = pixel_hit(pixel_ray());
    if (hit.instance == NONE || !is_reflector(hit.instance)) discard;
    int left = 0;
    for (int object = 0; object < objects; ++object) left += in_region(hit, object) ? 1 : 0;
    float share = float(left) / float(max(objects - 1, 1));
    color = weight * (left > 0 ? vec4(0.0, 0.25 + 0.75 * share, 0.0, 1.0) : vec4(0.5, 0.0, 0.0, 0.0));
}
