#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"
#include "ink_shape.glsl"

// A leaf as the sun sees it: cut to the shape that it has in the picture.

layout(set = 0, binding = 3) uniform sampler2D shapes;

layout(location = 0) in vec2 in_local;
layout(location = 1) flat in uint in_shape;
layout(location = 2) flat in float in_threshold;

void main() {
    if (leaf_alpha(shapes, in_local, in_shape) < in_threshold) {
        discard;
    }
}
