// A kernel of 4 by 4 texels; its middle is the corner that the inner four share.

const vec4 KERNEL = vec4(1.0, 3.0, 3.0, 1.0) / 8.0;

float kernel_weight(int tap) {
    return KERNEL[tap & 3] * KERNEL[tap >> 2];
}

// 0 to 3 each.
ivec2 kernel_place(int tap) {
    return ivec2(tap & 3, tap >> 2);
}
