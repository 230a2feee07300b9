#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"

// A particle as a fan of triangles about its middle, parallel to the picture: its depth is the same
// everywhere, so that thresholds do not depend on the place in it.

layout(set = 0, binding = 0, scalar) restrict readonly buffer Frame { InkFrame frame; };
layout(set = 0, binding = 1, scalar) restrict readonly buffer Particles { PaperParticle particles[]; };
layout(set = 0, binding = 2, scalar) restrict readonly buffer Outlines { vec2 outlines[]; };
layout(push_constant, scalar) uniform Push { PaperPrimitive push; };

#include "ink_primitive.glsl"

layout(location = 0) flat out vec2 out_depth_number;

void main() {
    uint vertex = uint(gl_VertexIndex);
    uint corners = 3u * push.points;
    uint number = vertex / corners;
    uint side = (vertex % corners) / 3u;
    uint corner = vertex % 3u;
    PaperParticle particle = particles[number];
    vec2 local = vec2(0.0);
    if (corner > 0u) {
        uint k = (side + corner - 1u) % push.points;
        local = primitive_point(particle, k, push.points, push.views, push.deformation);
    }
    vec3 position = particle.centre + particle.radius * (local.x * frame.right + local.y * frame.up);
    // Exact as a float up to 2^24 particles.
    out_depth_number = vec2(dot(particle.centre - frame.eye, frame.forward), float(number + 1u));
    gl_Position = frame.relative_to_clip * vec4(position, 1.0);
}
