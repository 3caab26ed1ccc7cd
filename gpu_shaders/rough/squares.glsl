// Which pixel of its square a ray is sent for, where only one of every STRIDE by STRIDE sends one: the last two bits of
// how far away that pixel's place on the mirror is.

float marked(float away, ivec2 in_square) {
    return uintBitsToFloat((floatBitsToUint(away) & ~3u) | uint(in_square.x + 2 * in_square.y));
}

ivec2 pixel_of(ivec2 texel, float away) {
    uint place = floatBitsToUint(away) & 3u;
    return STRIDE == 1 ? texel : STRIDE * texel + ivec2(place & 1u, place >> 1u);
}

// The one that is asked first, by the number of the sample.
ivec2 first_in_square(int number) {
    return ivec2(number, number >> 1) & 1;
}
