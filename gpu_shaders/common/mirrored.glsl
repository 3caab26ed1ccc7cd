// What a viewer sees in a mirror.

struct Mirrored {
    vec3 radiance;   // its reflectance counted in
    float distance;  // metres from the surface to what is seen; FAR for the world
};
