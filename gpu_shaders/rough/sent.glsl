// Where the rays of a picture end, and which pixels have sent them.

#include "rough/squares.glsl"

uniform sampler2D ends;  // as common/rough.glsl writes them

#if STRIDE > 1
ivec2 own_pixel() {
    ivec2 here = ivec2(gl_FragCoord.xy);
    return pixel_of(here, texelFetch(ends, here, 0).w);
}
#endif
