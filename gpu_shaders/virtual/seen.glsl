// What a mirrored ray meets is an instance, plus 1, and a triangle; or one of these.

const uint NOT_SEARCHED = 0u, WORLD_SEEN = 0xffffffffu;
