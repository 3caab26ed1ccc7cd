// Attenuation planes without end: each is four triangles around the point under the viewer's eye, whose other
// corners lie at infinity.

uniform mat4 frame;  // clip space: the viewer's foot, then the ways up from the mirror, ahead and across

in vec3 plane;  // metres above the foot; how steeply it rises ahead; the share of light that it lets through

flat out float passed;

void main() {
    vec4 along = frame[2] + plane.y * frame[1];
    vec4 ways[4] = vec4[4](along, frame[3], -along, -frame[3]);
    int corner = gl_VertexID % 3;
    gl_Position = corner == 0 ? frame[0] + plane.x * frame[1] : ways[(gl_VertexID / 3 + corner) & 3];
    passed = plane.z;
}
