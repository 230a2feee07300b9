#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"
#include "dispatch.glsl"
#include "packing.glsl"
#include "shade.glsl"

// Evaluates eq. 1 for a list of cases with the functions of the fragment shaders: the half of
// the comparison with src/reference/shade.rs that runs on the device.

layout(local_size_x = GROUP_1D) in;
layout(set = 0, binding = 0, scalar) restrict readonly buffer Probes { ShadeProbe probes[]; };
layout(set = 0, binding = 1, scalar) restrict writeonly buffer Shaded { vec4 shaded[]; };
layout(push_constant, scalar) uniform Push { ShadeProbes push; };

void main() {
    uint i = flat_invocation();
    if (i >= push.count) {
        return;
    }
    ShadeProbe p = probes[i];
    vec3 normal = unpack_normal16(p.normal);
    vec3 light = p.albedo * p.ambient * ambient_intensity(normal, push.sky_zenith, push.sky_ground);
    light += p.light * p.shadow
        * reflected(normal, p.to_light, p.to_eye, p.albedo, p.specular, p.shininess, p.transmission);
    shaded[i] = vec4(light, ground_ambient(p.to_light * 3.0, 1.0 + p.ambient, p.shadow));
}
