#ifndef RENDER_MATERIAL_GLSL
#define RENDER_MATERIAL_GLSL

// A fragment of the model: interpolated vertex, material, and what follows from both.

#include "interface.glsl"
#include "surface_record.glsl"

layout(constant_id = 1) const bool HAS_TEXTURE = false;  // the material's base colour texture
layout(constant_id = 2) const bool HAS_COLOR = false;    // vertex colours
layout(constant_id = 5) const bool COVERAGE = false;     // alpha becomes sample coverage

layout(set = 1, binding = 0) uniform sampler2D base_color_map;
layout(push_constant, scalar) uniform Push { RenderMaterial material; };

layout(location = 0) in vec3 in_position;
layout(location = 1) in vec4 in_shading;    // normal and ambient coefficient
layout(location = 2) in vec2 in_texcoord;
layout(location = 3) in vec3 in_color;

// Cuts the fragment away where alpha says so and returns its coverage. With multisampling the
// cut is a ramp one pixel wide about the cutoff.
float cut(float alpha) {
    if (COVERAGE) {
        float width = max(fwidth(alpha), 1e-4);
        return clamp((alpha - material.cutoff) / width + 0.5, 0.0, 1.0);
    }
    return alpha < material.cutoff ? 0.0 : 1.0;
}

// The surface under this fragment and the share of the pixel that it covers.
Surface surface(out float coverage) {
    // Derivatives come first, while all four pixels of a quad are still alive.
    vec3 across = cross(dFdx(in_position), dFdy(in_position));
    vec4 base = material.base_color;
    if (HAS_TEXTURE) {
        base *= texture(base_color_map, in_texcoord);
    }
    coverage = material.cutoff > 0.0 ? cut(base.a) : 1.0;
    Surface s;
    s.albedo = TEXTURED ? base.rgb : frame.clay;
    if (HAS_COLOR && TEXTURED) {
        s.albedo *= in_color;
    }
    bool flips = (material.flags & MATERIAL_FLIP) != 0u && !gl_FrontFacing;
    s.normal = flips ? -in_shading.xyz : in_shading.xyz;
    s.ambient = in_shading.w;
    s.material = material.id;
    float along = dot(across, frame.sun_direction);
    s.steepness = sqrt(max(1.0 - along * along / max(dot(across, across), 1e-30), 0.0));
    return s;
}

#endif
