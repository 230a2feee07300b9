#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"
#include "ink_shape.glsl"

// A leaf as the sun sees it: cut to the shape that it has in the picture.

layout(set = 0, binding = 3) uniform sampler2D shapes;
layout(set = 0, binding = 4, scalar) restrict readonly buffer Styles { InkStyle styles[]; };
layout(push_constant, scalar) uniform Push { InkLeafDraw push; };

layout(location = 1) in vec2 in_local;
layout(location = 4) flat in uvec4 in_ids;

void main() {
    if (leaf_alpha(shapes, in_local, in_ids.z) < styles[in_ids.w].shape) {
        discard;
    }
}
