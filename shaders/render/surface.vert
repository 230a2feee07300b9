#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"
#include "packing.glsl"

// A vertex of the model. Normal and ambient coefficient are decoded here, per vertex: encoded
// vectors must not be interpolated.

layout(constant_id = 0) const uint NORMALS = NORMALS_PACKED;
layout(constant_id = 1) const bool HAS_TEXTURE = false;
layout(constant_id = 2) const bool HAS_COLOR = false;

layout(set = 0, binding = 0, scalar) uniform Frame { RenderFrame frame; };
layout(set = 0, binding = 1, scalar) restrict readonly buffer Positions { vec3 positions[]; };
layout(set = 0, binding = 2, scalar) restrict readonly buffer Normals { uint normals[]; };
layout(set = 0, binding = 3, scalar) restrict readonly buffer Texcoords { vec2 texcoords[]; };
layout(set = 0, binding = 4, scalar) restrict readonly buffer Colors { uvec2 colors[]; };
layout(push_constant, scalar) uniform Push { RenderMaterial material; };

layout(location = 0) out vec3 out_position;
layout(location = 1) out vec4 out_shading;
layout(location = 2) out vec2 out_texcoord;
layout(location = 3) out vec3 out_color;

vec3 float_normal(uint first) {
    return uintBitsToFloat(uvec3(normals[first], normals[first + 1u], normals[first + 2u]));
}

vec4 decode_shading(uint vertex) {
    if (NORMALS == NORMALS_OWN) {
        return vec4(unpack_normal16(normals[vertex]), 1.0);
    }
    if (NORMALS == NORMALS_LENGTH) {
        vec3 v = float_normal(3u * vertex);
        float k = length(v);
        return vec4(v / k, k);
    }
    if (NORMALS == NORMALS_FLOAT) {
        return vec4(float_normal(4u * vertex), uintBitsToFloat(normals[4u * vertex + 3u]));
    }
    vec2 ambient = unpackUnorm2x16(normals[2u * vertex + 1u]);
    return vec4(unpack_normal16(normals[2u * vertex]), ambient.x);
}

void main() {
    uint vertex = uint(gl_VertexIndex);
    out_position = positions[vertex];
    out_shading = decode_shading(vertex);
    out_texcoord = vec2(0.0);
    out_color = vec3(1.0);
    if (HAS_TEXTURE) {
        vec3 uv = vec3(texcoords[vertex], 1.0);
        out_texcoord = vec2(dot(material.texcoord_u, uv), dot(material.texcoord_v, uv));
    }
    if (HAS_COLOR) {
        uvec2 c = colors[vertex];
        out_color = vec3(unpackHalf2x16(c.x), unpackHalf2x16(c.y).x);
    }
    gl_Position = frame.relative_to_clip * vec4(out_position, 1.0);
}
