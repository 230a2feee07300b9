#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"
#include "ink_raster.glsl"

// A particle as triangles parallel to the picture: its depth is the same
// everywhere, so that thresholds do not depend on the place in it.

layout(set = 0, binding = 0, scalar) restrict readonly buffer Frame { InkFrame frame; };
layout(set = 0, binding = 1, scalar) restrict readonly buffer Particles { PaperParticle particles[]; };
layout(set = 0, binding = 2, scalar) restrict readonly buffer Outlines { vec2 outlines[]; };
layout(set = 0, binding = 3, scalar) restrict readonly buffer Corners { uint corners[]; };
layout(push_constant, scalar) uniform Push { PaperPrimitive push; };

#include "ink_primitive.glsl"

layout(location = 0) flat out vec2 out_depth_number;

void main() {
    uint vertex = uint(gl_VertexIndex);
    uint corners_each = 3u * push.points;
    uint number = vertex / corners_each;
    PaperParticle particle = particles[number];
    // Filled as the nearest of the nine views is.
    uint view = 0u;
    if (push.views == 9u) {
        vec2 nearest = clamp(floor(particle.tilt + 1.5), vec2(0.0), vec2(2.0));
        view = 3u * uint(nearest.y) + uint(nearest.x);
    }
    uint corner = corners[view * corners_each + vertex % corners_each];
    vec2 local = vec2(0.0);
    if (corner != PAPER_MIDDLE) {
        local = primitive_point(particle, corner, push.points, push.views, push.deformation);
    }
    precise vec3 position = particle.centre + particle.radius * (local.x * frame.right + local.y * frame.up);
    // Exact as a float up to 2^24 particles.
    out_depth_number = vec2(dot(particle.centre - frame.eye, frame.forward), float(number + 1u));
    gl_Position = on_raster(to_clip(frame.relative_to_clip, vec4(position, 1.0)), vec2(frame.width, frame.height));
}
