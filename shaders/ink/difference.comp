#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"

// Depth differences (Deussen and Strothotte 2000, section 3.2): how far a pixel is before the
// farthest of its eight neighbours, in units of 1/65535 of the range; 0 where it is before none.

layout(local_size_x = 8, local_size_y = 8) in;
layout(set = 0, binding = 0) uniform sampler2D depth_map;
layout(set = 0, binding = 1, r32f) uniform restrict writeonly image2D differences;
layout(push_constant, scalar) uniform Push { PaperDifference push; };

// Depth as it is compared; what shows nothing is infinitely far, or as far as z1.
float depth_at(ivec2 at) {
    at = clamp(at, ivec2(0), ivec2(push.width, push.height) - 1);
    float depth = texelFetch(depth_map, at, 0).r;
    if (depth <= 0.0) {
        return push.sky_at_far != 0u ? PAPER_DEPTHS : PAPER_INFINITE;
    }
    float share = (depth - push.nearest) / (push.farthest - push.nearest);
    float z = push.near + share * (push.far - push.near);
    // Equation 1 with the division that its print lacks, solved for the buffer's value.
    float mapped = push.far * (z - push.near) / (z * (push.far - push.near));
    return PAPER_DEPTHS * (push.mapped != 0u ? mapped : share);
}

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (pixel.x >= int(push.width) || pixel.y >= int(push.height)) {
        return;
    }
    float most = 0.0;
    if (texelFetch(depth_map, pixel, 0).r > 0.0) {
        float own = depth_at(pixel);
        float slope = 0.0;
        for (int k = 0; k < 4; k++) {
            ivec2 step = k == 1 ? ivec2(1, 1) : k == 2 ? ivec2(0, 1) : k == 3 ? ivec2(-1, 1) : ivec2(1, 0);
            float ahead = depth_at(pixel + step) - own;
            float behind = depth_at(pixel - step) - own;
            most = max(most, max(ahead, behind));
            // The surface goes on to the side where depth changes less.
            slope = max(slope, min(abs(ahead), abs(behind)));
        }
        most = max(most - push.slope * min(slope, PAPER_DEPTHS), 0.0);
    }
    imageStore(differences, pixel, vec4(most));
}
