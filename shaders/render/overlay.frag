#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "interface.glsl"

// The implicit surface, half transparent over the tree.

layout(push_constant, scalar) uniform Push { RenderOverlay overlay; };

layout(location = 0) in vec3 in_position;
layout(location = 1) in vec3 in_normal;
layout(location = 0) out vec4 out_color;

void main() {
    vec3 light = illuminate(in_position, normalize(in_normal), overlay.color, 1.0, 1.0, 0.1, 24.0,
                            vec3(0.0));
    out_color = vec4(light * frame.exposure, overlay.opacity);
}
