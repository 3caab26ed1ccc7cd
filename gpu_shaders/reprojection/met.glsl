// What a ray met is named by an instance + 1 and a triangle; 0 and 0 where no ray was.

const uint WORLD_MET = 0xffffffffu;   // instead of an instance
const uint DOUBTFUL = 0x80000000u;    // added to a triangle
