#ifndef RENDER_MATERIAL_GLSL
#define RENDER_MATERIAL_GLSL

// A fragment of the model: interpolated vertex, material, and what follows from both.

#include "interface.glsl"

layout(set = 1, binding = 0) uniform sampler2D base_color_map;
layout(push_constant, scalar) uniform Push { RenderMaterial material; };

layout(location = 0) in vec3 in_position;
layout(location = 1) in vec4 in_shading;    // normal and ambient coefficient
layout(location = 2) in vec2 in_texcoord;
layout(location = 3) in vec3 in_color;

struct Fragment {
    vec3 albedo;
    float coverage;
    vec3 normal;
    float ambient;
    float sun;      // S
    vec3 light;     // eq. 1, without exposure
};

// Cuts the fragment away where alpha says so and returns its coverage. With multisampling the
// cut is a ramp one pixel wide about the cutoff, which becomes sample coverage.
float cut(float alpha) {
    if (COVERAGE) {
        float width = max(fwidth(alpha), 1e-4);
        float coverage = clamp((alpha - material.cutoff) / width + 0.5, 0.0, 1.0);
        if (coverage < 0.125) {
            discard;
        }
        return coverage;
    }
    if (alpha < material.cutoff) {
        discard;
    }
    return 1.0;
}

// `lit` off leaves out the light (for passes that only want attributes).
Fragment fragment(bool lit) {
    Fragment f;
    // Derivatives come first, while all four pixels of a quad are still alive.
    vec3 across = cross(dFdx(in_position), dFdy(in_position));
    vec4 base = material.base_color;
    if (HAS_TEXTURE) {
        base *= texture(base_color_map, in_texcoord);
    }
    f.coverage = material.cutoff > 0.0 ? cut(base.a) : 1.0;
    f.albedo = TEXTURED ? base.rgb : frame.clay;
    if (HAS_COLOR && TEXTURED) {
        f.albedo *= in_color;
    }
    bool flips = (material.flags & MATERIAL_FLIP) != 0u && !gl_FrontFacing;
    f.normal = normalize(in_shading.xyz) * (flips ? -1.0 : 1.0);
    f.ambient = in_shading.w;
    f.sun = 1.0;
    f.light = vec3(0.0);
    if (!lit) {
        return f;
    }
    if (SHADOWED) {
        vec3 geometric = across * inversesqrt(max(dot(across, across), 1e-30));
        f.sun = sun_visibility(in_position, geometric);
    }
    if ((material.flags & MATERIAL_UNLIT) != 0u && TEXTURED) {
        f.light = f.albedo / frame.exposure;
        return f;
    }
    f.light = illuminate(in_position, f.normal, f.albedo, f.ambient, f.sun, material.specular,
                         material.shininess, material.transmission);
    if (TEXTURED) {
        f.light += material.emissive;
    }
    return f;
}

#endif
