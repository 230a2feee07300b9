#ifndef LIT_PIXEL_GLSL
#define LIT_PIXEL_GLSL

#include "packing.glsl"

// What the first pass of lit pictures leaves of the leaf at a pixel, in two targets.

struct PixelLeaf {
    // Diffuse reflectance of the side that is seen, and transmittance.
    vec3 rho_d;
    vec3 rho_t;
    // Specular intensity and roughness of the side that is seen.
    vec4 shine;
    uint material;
    // Normal of the triangle, towards the eye, within a degree.
    vec3 face;
};

uvec4 pack_leaf(PixelLeaf leaf) {
    return uvec4(packHalf2x16(leaf.rho_d.xy), packHalf2x16(vec2(leaf.rho_d.z, leaf.shine.w)),
        packHalf2x16(leaf.rho_t.xy), packHalf2x16(vec2(leaf.rho_t.z, 0.0)) | pack_normal8(leaf.face) << 16u);
}

vec4 pack_shine(PixelLeaf leaf) {
    return vec4(leaf.shine.rgb, float(leaf.material));
}

PixelLeaf unpack_leaf(uvec4 leaf, vec4 shine) {
    vec2 middle = unpackHalf2x16(leaf.y);
    vec3 rho_d = vec3(unpackHalf2x16(leaf.x), middle.x);
    vec3 rho_t = vec3(unpackHalf2x16(leaf.z), unpackHalf2x16(leaf.w).x);
    vec3 face = unpack_normal8(leaf.w >> 16u);
    return PixelLeaf(rho_d, rho_t, vec4(shine.rgb, middle.y), uint(shine.w + 0.5), face);
}

#endif
