#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"
#include "dispatch.glsl"
#include "surface.glsl"

// Outward normals of the surface's vertices: -grad F, or the area-weighted mean of the faces
// around, which also stands in where the gradient vanishes. The faces around a vertex are those
// of the four cells that share its edge.

layout(local_size_x = GROUP_1D) in;
layout(constant_id = 0) const uint FROM_GRADIENT = 1;
layout(set = 0, binding = 0, scalar) restrict readonly buffer Density { float density[]; };
layout(set = 0, binding = 1, scalar) restrict readonly buffer Cases { uint cases[]; };
layout(set = 0, binding = 2, scalar) restrict readonly buffer NodeFirst { uint node_first[]; };
layout(set = 0, binding = 3, scalar) restrict readonly buffer Vertices { vec4 vertices[]; };
layout(set = 0, binding = 4, scalar) restrict readonly buffer Gradients { vec4 gradients[]; };
layout(set = 0, binding = 5, scalar) restrict writeonly buffer Normals { vec4 normals[]; };
layout(push_constant, scalar) uniform Push { SurfaceGrid push; };

uvec3 steps() {
    return uvec3(1u, push.nodes.x, push.nodes.x * push.nodes.y);
}

uint cell_state(uint cell) {
    uint state = 0u;
    for (uint corner = 0u; corner < 8u; ++corner) {
        uvec3 o = corner_offset(corner) * steps();
        state |= uint(density[cell + o.x + o.y + o.z] > push.tau) << corner;
    }
    return state;
}

uint edge_vertex(uint cell, uint edge) {
    uvec3 o = corner_offset(edge_corner(edge)) * steps();
    return vertex_number(node_first[cell + o.x + o.y + o.z], edge >> 2u);
}

// Sum of twice the area vectors of the cell's triangles that touch `own`.
vec3 area_around(uint cell, uint own) {
    uint state = cell_state(cell);
    vec3 sum = vec3(0.0);
    for (uint c = cases[state]; c < cases[state + 1u]; c += 3u) {
        uvec3 edges = uvec3(cases[CASE_OFFSETS + c], cases[CASE_OFFSETS + c + 1u], cases[CASE_OFFSETS + c + 2u]);
        if (any(equal(edges, uvec3(own)))) {
            vec3 a = vertices[edge_vertex(cell, edges.x)].xyz;
            vec3 b = vertices[edge_vertex(cell, edges.y)].xyz;
            vec3 d = vertices[edge_vertex(cell, edges.z)].xyz;
            sum += cross((b - a) / push.cell, (d - a) / push.cell);
        }
    }
    return sum;
}

vec3 face_normal(uint owner) {
    uint axis = owner & 3u;
    uint number = owner >> 2u;
    uvec3 node = uvec3(number % push.nodes.x, number / push.nodes.x % push.nodes.y,
        number / (push.nodes.x * push.nodes.y));
    uint u = (axis + 1u) % 3u;
    uint v = (axis + 2u) % 3u;
    vec3 sum = vec3(0.0);
    for (uint k = 0u; k < 4u; ++k) {
        uint back_u = k & 1u;
        uint back_v = k >> 1u;
        bool exists = node[u] >= back_u && node[v] >= back_v
            && node[u] - back_u + 1u < push.nodes[u] && node[v] - back_v + 1u < push.nodes[v];
        if (exists) {
            uint cell = number - back_u * steps()[u] - back_v * steps()[v];
            // The edge's low corner seen from this cell.
            uint corner = (back_u << u) | (back_v << v);
            sum += area_around(cell, edge_number(corner, axis));
        }
    }
    float size = length(sum);
    return size > 0.0 ? sum / size : vec3(0.0, 0.0, 1.0);
}

void main() {
    uint i = flat_invocation();
    if (i >= push.count) {
        return;
    }
    vec3 normal = vec3(0.0);
    float size = 0.0;
    if (FROM_GRADIENT != 0u) {
        vec3 gradient = gradients[i].yzw;
        size = length(gradient);
        normal = -gradient / max(size, 1e-30);
    }
    if (size * push.radius <= GRADIENT_FLOOR) {
        normal = face_normal(floatBitsToUint(vertices[i].w));
    }
    normals[i] = vec4(normal, 0.0);
}
