#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"
#include "dispatch.glsl"

// Diffuse reflectance and transmittance of every texel of one side of a leaf (Wang et al. 2005,
// section 3).

layout(local_size_x = GROUP_1D) in;
layout(set = 0, binding = 0, scalar) restrict readonly buffer SlabTable { vec2 slab_table[]; };
// gamma in rgb, deviation of the thickness over the thickness in a.
layout(set = 0, binding = 1, scalar) restrict readonly buffer Maps { vec4 gamma_delta[]; };
layout(set = 0, binding = 2, scalar) restrict writeonly buffer Reflected { vec3 rho_d[]; };
layout(set = 0, binding = 3, scalar) restrict writeonly buffer Transmitted { vec3 rho_t[]; };
layout(push_constant, scalar) uniform Push { LeafTissue push; };

#include "leaf_slab.glsl"

void main() {
    uint i = flat_invocation();
    if (i >= push.count) {
        return;
    }
    vec4 texel = gamma_delta[i];
    vec3 back;
    vec3 through;
    for (uint c = 0u; c < 3u; c++) {
        vec2 share = leaf_share(push.absorption[c], push.scattering[c], 1.0 + texel.a, texel[c],
            vec2(push.a[c], push.b[c]), push.mode);
        back[c] = share.x;
        through[c] = share.y;
    }
    rho_d[i] = back;
    rho_t[i] = through;
}
