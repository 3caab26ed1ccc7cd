// Which objects a reflector's triangle may show (addon/baking/regions.py).

#include "common/scene.glsl"

uniform usampler2D regions;  // an instance's first word, less its mesh's; then the words of every reflector's triangles
uniform int region_words;    // words a triangle, 32 objects a word

bool in_region(Hit from, int object) {
    uint start = texelFetch(regions, texel_at(from.instance), 0).x;
    int word = int(start + uint(from.triangle * region_words + object / 32));
    return ((texelFetch(regions, texel_at(word), 0).x >> (object & 31)) & 1u) != 0u;
}
