// How well a pixel of the key frame reflects a point to an eye (Xie et al., 3.2.1, figure 4).

#include "reprojection_published/known.glsl"

uniform vec4 eye;  // a point and 1; for parallel rays the direction to it and 0

// The distance function: metres from the eye to the ray from `point`, mirrored in the pixel's tangent plane, through
// the pixel's surface; for parallel rays the sine of the angle between.
float distance_of(Known at, vec3 point) {
    vec3 image = reflect(point - at.position, at.normal);  // M, from the surface
    vec3 to_eye = eye.xyz - eye.w * at.position;
    vec3 along = -normalize(image);
    bool is_before = dot(to_eye - eye.w * image, along) < 0.0;
    return is_before ? length(to_eye - eye.w * image) : length(cross(to_eye, along));
}
