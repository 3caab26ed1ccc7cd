// Which flat part of which instance is the mirror.

uniform usampler2D mirror_parts;  // 1 texel a triangle of a reflector: the number of its flat part, 0 for none
uniform ivec3 mirror;             // instance; number of the part; where the first of all triangles would stand

bool shows_mirror(int instance, int triangle) {
    return instance == mirror.x && texelFetch(mirror_parts, texel_at(mirror.z + triangle), 0).x == uint(mirror.y);
}
