#version 460

// Depth and number of a particle.

layout(location = 0) flat in vec2 in_depth_number;
layout(location = 0) out float out_depth;
layout(location = 1) out float out_number;

void main() {
    out_depth = in_depth_number.x;
    out_number = in_depth_number.y;
}
