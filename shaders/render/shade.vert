#version 460

// One triangle over the whole picture.

layout(location = 0) out vec2 out_corner;

void main() {
    out_corner = vec2((gl_VertexIndex << 1) & 2, gl_VertexIndex & 2) * 2.0 - 1.0;
    gl_Position = vec4(out_corner, 0.0, 1.0);
}
