#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"
#include "ink_raster.glsl"

// A particle as a triangle, parallel to the picture, in which the fragment finds its ellipse: half as
// much to set up as a square, of which drawings of many small particles are mostly made.

layout(set = 0, binding = 0, scalar) restrict readonly buffer Frame { InkFrame frame; };
layout(set = 0, binding = 1, scalar) restrict readonly buffer Particles { PaperParticle particles[]; };
layout(push_constant, scalar) uniform Push { PaperEllipse push; };

layout(location = 0) flat out vec2 out_depth_number;
layout(location = 1) flat out vec4 out_waves;
// From pixels to the circle that the ellipse is made of: columns, and what becomes its middle.
layout(location = 2) flat out vec4 out_to_circle;
layout(location = 3) flat out vec2 out_middle;

// Of the triangle with equal sides about the circle of radius 1.
const vec2 CORNERS[3] = vec2[](vec2(-1.7320508, -1.0), vec2(1.7320508, -1.0), vec2(0.0, 2.0));
// By how much the triangle is larger, pixels: more than devices round its corners by.
const float MARGIN = 0.125;

void main() {
    uint vertex = uint(gl_VertexIndex);
    PaperParticle particle = particles[vertex / 3u];
    vec2 extent = vec2(frame.width, frame.height);
    vec4 clip = to_clip(frame.relative_to_clip, vec4(particle.centre, 1.0));
    precise vec2 to_pixels = 0.5 * extent / clip.w;
    precise vec2 right = to_pixels * to_clip(frame.relative_to_clip, vec4(particle.radius * frame.right, 0.0)).xy;
    precise vec2 up = to_pixels * to_clip(frame.relative_to_clip, vec4(particle.radius * frame.up, 0.0)).xy;
    // The ellipse's axes in the picture, and what undoes them.
    precise vec2 x = right * particle.turn.x + up * particle.turn.y;
    precise vec2 y = push.aspect * (up * particle.turn.x - right * particle.turn.y);
    precise float area = x.x * y.y - x.y * y.x;
    precise vec4 to_circle = vec4(y.y, -x.y, -y.x, x.x) / area;
    precise vec2 middle = to_pixels * clip.xy + 0.5 * extent;
    out_to_circle = to_circle;
    out_middle = middle;
    // Exact as a float up to 2^24 particles.
    out_depth_number = vec2(dot(particle.centre - frame.eye, frame.forward), float(vertex / 3u + 1u));
    out_waves = particle.waves;
    float margin = MARGIN / max(length(right) * min(push.aspect, 1.0), 1e-3);
    vec2 corner = CORNERS[vertex % 3u] * (1.0 + push.deformation + margin);
    gl_Position = vec4(clip.xy + (corner.x * x + corner.y * y) / to_pixels, clip.zw);
}
