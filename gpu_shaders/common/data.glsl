// Tables that the CPU lays out as rows of texels (addon/gl/textures.py).

ivec2 texel_at(int index) {
    return ivec2(index & 4095, index >> 12);
}
