#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
#include "abi.glsl"
#include "dispatch.glsl"
#include "random.glsl"

// Light of the surroundings that the glossy lobe of each receiver reflects towards the eye, from
// its front and from its back: b(v) . l^T of Wang et al. 2005, section 4.1. The lobe is tabulated
// over the angle of view with the eye in the half plane y = 0, x > 0 of the frame of
// the normal, where it has cosines of the azimuth only; turning it to the eye mixes +m and -m.

// Bands of the light.
layout(constant_id = 0) const uint ORDER = 5u;
const uint COEFFICIENTS = ORDER * ORDER;

layout(local_size_x = GROUP_1D) in;
layout(set = 0, binding = 0, scalar) restrict readonly buffer Receivers { Receiver receivers[]; };
// Incident light of every receiver, in the frame of its normal.
layout(set = 0, binding = 1, scalar) restrict readonly buffer Light { vec3 light[]; };
layout(set = 0, binding = 2, scalar) restrict readonly buffer Lobes { float lobes[]; };
layout(set = 0, binding = 3, scalar) restrict readonly buffer Gloss { vec4 gloss[]; };
layout(set = 0, binding = 4, scalar) restrict writeonly buffer Radiance { vec3 radiance[]; };
layout(push_constant, scalar) uniform Push { GlossView push; };

void main() {
    uint id = flat_invocation();
    if (id >= push.count) {
        return;
    }
    Receiver receiver = receivers[id];
    vec3 to_eye = normalize(push.eye - receiver.position);
    // The eye in the frame of the normal.
    float x = dot(to_eye, to_frame(receiver.normal, vec3(1.0, 0.0, 0.0)));
    float y = dot(to_eye, to_frame(receiver.normal, vec3(0.0, 1.0, 0.0)));
    float z = dot(to_eye, receiver.normal);
    float across = sqrt(x * x + y * y);
    vec2 turn = across > 0.0 ? vec2(x, y) / across : vec2(1.0, 0.0);
    float at = atan(across, abs(z)) * (float(LOBE_NODES - 1u) / 1.5707963267948966);
    uint node = min(uint(at), LOBE_NODES - 2u);
    float share = at - float(node);
    uint first = (receiver.material * LOBE_NODES + node) * LOBE_COEFFICIENTS;
    vec3 front = vec3(0.0);
    vec3 back = vec3(0.0);
    vec2 azimuth = vec2(1.0, 0.0);
    [[unroll]] for (uint m = 0u; m < ORDER; ++m) {
        [[unroll]] for (uint l = m; l < ORDER; ++l) {
            uint k = l * (l + 1u) / 2u + m;
            float lobe = mix(lobes[first + k], lobes[first + LOBE_COEFFICIENTS + k], share);
            uint centre = id * COEFFICIENTS + l * (l + 1u);
            vec3 term = lobe * azimuth.x * light[centre + m];
            if (m > 0u) {
                term += lobe * azimuth.y * light[centre - m];
            }
            front += term;
            // Seen from below everything is mirrored.
            back += ((l + m) & 1u) == 0u ? term : -term;
        }
        azimuth = vec2(turn.x * azimuth.x - turn.y * azimuth.y, turn.y * azimuth.x + turn.x * azimuth.y);
    }
    vec3 own = gloss[receiver.material].xyz;
    radiance[2u * id] = own * front;
    radiance[2u * id + 1u] = own * back;
}
