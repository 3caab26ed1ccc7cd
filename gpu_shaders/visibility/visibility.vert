// A mesh as the camera sees it. CUTS, the number of planes that geometry is cut by, is defined by the program.

uniform mat4 object_to_clip;
#if CUTS > 0
uniform vec4 cuts[CUTS];  // in the mesh's space; what is on their negative side is cut away
out float gl_ClipDistance[CUTS];
#endif

in vec3 position;

void main() {
    gl_Position = object_to_clip * vec4(position, 1.0);
#if CUTS > 0
    for (int i = 0; i < CUTS; ++i) gl_ClipDistance[i] = dot(cuts[i], vec4(position, 1.0));
#endif
}
