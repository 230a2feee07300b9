#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"

// A particle as a triangle, parallel to the picture, in which the fragment finds its ellipse: half as
// much to set up as a square, of which drawings of many small particles are mostly made.

layout(set = 0, binding = 0, scalar) restrict readonly buffer Frame { InkFrame frame; };
layout(set = 0, binding = 1, scalar) restrict readonly buffer Particles { PaperParticle particles[]; };
layout(push_constant, scalar) uniform Push { PaperEllipse push; };

layout(location = 0) flat out vec2 out_depth_number;
layout(location = 1) flat out vec4 out_phase;
layout(location = 2) out vec2 out_local;

// Of the triangle with equal sides about the circle of radius 1.
const vec2 CORNERS[3] = vec2[](vec2(-1.7320508, -1.0), vec2(1.7320508, -1.0), vec2(0.0, 2.0));

void main() {
    uint vertex = uint(gl_VertexIndex);
    PaperParticle particle = particles[vertex / 3u];
    vec2 local = CORNERS[vertex % 3u] * (1.0 + push.deformation) * vec2(1.0, push.aspect);
    vec2 turned = vec2(particle.turn.x * local.x - particle.turn.y * local.y,
                       particle.turn.y * local.x + particle.turn.x * local.y);
    vec3 position = particle.centre + particle.radius * (turned.x * frame.right + turned.y * frame.up);
    // Exact as a float up to 2^24 particles.
    out_depth_number = vec2(dot(particle.centre - frame.eye, frame.forward), float(vertex / 3u + 1u));
    out_phase = vec4(cos(particle.phase), sin(particle.phase));
    out_local = local;
    gl_Position = frame.relative_to_clip * vec4(position, 1.0);
}
