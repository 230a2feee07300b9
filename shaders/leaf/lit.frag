#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"
#include "lit_pixel.glsl"

// First pass: light of the sky and light between leaves, and what the second pass needs of the
// leaf. Light of the vertices is that of the material's means; at a pixel it follows the sum of
// what is reflected and transmitted there.

// Whether the material has maps of its own; otherwise its means follow the base colour.
layout(constant_id = 0) const uint MAPPED = 0;
layout(set = 0, binding = 6, scalar) restrict readonly buffer Materials { LeafSides materials[]; };
layout(set = 0, binding = 7, scalar) restrict readonly buffer Gloss { vec4 gloss[]; };
layout(set = 1, binding = 0) uniform sampler2D base_color_map;
// Diffuse reflectance and roughness of the two sides, transmittance, specular intensities.
layout(set = 1, binding = 1) uniform sampler2D front_map;
layout(set = 1, binding = 2) uniform sampler2D back_map;
layout(set = 1, binding = 3) uniform sampler2D through_map;
layout(set = 1, binding = 4) uniform sampler2D front_shine_map;
layout(set = 1, binding = 5) uniform sampler2D back_shine_map;
layout(push_constant, scalar) uniform Push { LitDraw push; };

layout(location = 0) in vec3 in_front;
layout(location = 1) in vec3 in_back;
layout(location = 2) in vec4 in_normal;
layout(location = 3) in vec2 in_texcoord;
layout(location = 4) in vec3 in_from_eye;

layout(location = 0) out vec4 out_light;
// Normal of the front; visibility of the sun plus 1, negative on the back.
layout(location = 1) out vec4 out_surface;
layout(location = 2) out uvec4 out_leaf;
layout(location = 3) out vec4 out_shine;

// Normal of the triangle, towards the eye.
vec3 face_normal() {
    vec3 face = cross(dFdx(in_from_eye), dFdy(in_from_eye));
    float size = dot(face, face);
    face = size > 0.0 ? face * inversesqrt(size) : -normalize(in_from_eye);
    return dot(face, in_from_eye) > 0.0 ? -face : face;
}

void main() {
    // Derivatives need the neighbours that are cut away.
    vec3 face = face_normal();
    vec4 base = texture(base_color_map, in_texcoord);
    if (base.a * push.alpha < push.cutoff) {
        discard;
    }
    LeafSides means = materials[push.material];
    PixelLeaf leaf;
    leaf.rho_d = gl_FrontFacing ? means.rho_d_front : means.rho_d_back;
    leaf.rho_t = means.rho_t;
    leaf.shine = gloss[push.material];
    leaf.material = push.material;
    leaf.face = face;
    vec3 share = base.rgb * push.tint;
    if (MAPPED != 0u) {
        vec3 mean = leaf.rho_d + leaf.rho_t;
        vec4 side = gl_FrontFacing ? textureLod(front_map, in_texcoord, 0.0) : textureLod(back_map, in_texcoord, 0.0);
        vec4 shine = gl_FrontFacing ? textureLod(front_shine_map, in_texcoord, 0.0)
                                    : textureLod(back_shine_map, in_texcoord, 0.0);
        leaf.rho_d = side.rgb;
        leaf.rho_t = textureLod(through_map, in_texcoord, 0.0).rgb;
        // The sign asks for a form of the lobe.
        leaf.shine = vec4(shine.rgb, leaf.shine.w < 0.0 ? -side.a : side.a);
        share = (leaf.rho_d + leaf.rho_t) / max(mean, vec3(1e-6));
    } else {
        leaf.rho_d *= share;
        leaf.rho_t *= share;
        leaf.shine.rgb *= share;
    }
    out_light = vec4((gl_FrontFacing ? in_front : in_back) * share, 1.0);
    float side = gl_FrontFacing ? 1.0 : -1.0;
    out_surface = vec4(normalize(in_normal.xyz), side * (1.0 + in_normal.w));
    out_leaf = pack_leaf(leaf);
    out_shine = pack_shine(leaf);
}
