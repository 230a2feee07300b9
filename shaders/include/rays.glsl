#ifndef RAYS_GLSL
#define RAYS_GLSL

// Rays, the triangle test and the compressed hierarchy; the other half is src/math/wide_bvh.rs.

// A ray with what its tests need of it.
struct Ray {
    vec3 origin;
    vec3 inverse;
    // The largest component of the direction is number `axis`; the ray is sheared onto it.
    uint axis;
    vec3 shear;
    // Number of a child in the order of the ray, as a flip of the bits of its place.
    uint order;
};

ivec2 ray_place(uint texel) {
    return ivec2(texel & ((1u << RAY_COLUMN_BITS) - 1u), texel >> RAY_COLUMN_BITS);
}

uvec4 ray_texel(usampler2D image, uint texel) {
    return texelFetch(image, ray_place(texel), 0);
}

vec4 ray_texel(sampler2D image, uint texel) {
    return texelFetch(image, ray_place(texel), 0);
}

// Components in the order in which the ray's largest axis comes last.
vec3 turned(vec3 v, uint axis) {
    return axis == 0u ? v.yzx : (axis == 1u ? v.zxy : v);
}

Ray make_ray(vec3 origin, vec3 direction) {
    Ray ray;
    ray.origin = origin;
    // Finite, so that a ray in the plane of a box's side (0 times infinity) still enters it.
    ray.inverse = clamp(1.0 / direction, vec3(-RAY_STEEP), vec3(RAY_STEEP));
    vec3 size = abs(direction);
    ray.axis = size.x >= size.y ? (size.x >= size.z ? 0u : 2u) : (size.y >= size.z ? 1u : 2u);
    vec3 d = turned(direction, ray.axis);
    ray.shear = vec3(d.xy, 1.0) / d.z;
    bvec3 back = lessThan(ray.inverse, vec3(0.0));
    ray.order = 7u ^ (uint(back.x) | uint(back.y) << 1u | uint(back.z) << 2u);
    return ray;
}

// Distance and barycentric weights; distance 0 for a miss. Either side is hit. The test of Woop,
// Benthin and Wald 2013, Watertight Ray/Triangle Intersection: the corners are moved to the ray's
// frame, each by itself, and the signs of the edge functions there decide. A rounded difference
// of products may be 0, but never has the wrong sign, and a 0 counts as a hit for both
// triangles of an edge: no ray slips through between them.
vec4 intersect(Ray ray, vec3 a, vec3 b, vec3 c) {
    precise vec3 pa = turned(a - ray.origin, ray.axis);
    precise vec3 pb = turned(b - ray.origin, ray.axis);
    precise vec3 pc = turned(c - ray.origin, ray.axis);
    precise vec2 qa = pa.xy - ray.shear.xy * pa.z;
    precise vec2 qb = pb.xy - ray.shear.xy * pb.z;
    precise vec2 qc = pc.xy - ray.shear.xy * pc.z;
    precise float u = qc.x * qb.y - qc.y * qb.x;
    precise float v = qa.x * qc.y - qa.y * qc.x;
    precise float w = qb.x * qa.y - qb.y * qa.x;
    float least = min(u, min(v, w));
    float most = max(u, max(v, w));
    precise float sum = u + v + w;
    vec3 weights = vec3(u, v, w) / sum;
    float t = ray.shear.z * (weights.x * pa.z + weights.y * pb.z + weights.z * pc.z);
    bool inside = (least >= 0.0 || most <= 0.0) && sum != 0.0;
    return vec4(inside ? t : 0.0, weights);
}

// Number of the highest bit, of a value whose lower 24 bits do not matter.
uint highest_bit(uint bits) {
    return 24u + (floatBitsToUint(float(bits >> 24u)) >> 23u) - 127u;
}

// Number of the lowest bit of a value below 2^24; any for 0.
uint lowest_bit(uint bits) {
    return bits == 0u ? 0u : (floatBitsToUint(float(bits & (~bits + 1u))) >> 23u) - 127u;
}

// Moves bit i to i ^ order, for 8 bits: the children nearest along the ray come to the top.
uint in_ray_order(uint bits, uint order) {
    bits = (order & 1u) != 0u ? (bits & 0x55u) << 1u | (bits & 0xaau) >> 1u : bits;
    bits = (order & 2u) != 0u ? (bits & 0x33u) << 2u | (bits & 0xccu) >> 2u : bits;
    return (order & 4u) != 0u ? (bits & 0x0fu) << 4u | bits >> 4u : bits;
}

// Texel of a cutout (first texel, width, height, wrap modes) at a texture coordinate.
uint cutout_along(float at, uint size, uint wrap) {
    float repeated = fract(at);
    float mirrored = 1.0 - abs(2.0 * fract(0.5 * at) - 1.0);
    float inside = wrap == CUTOUT_REPEAT ? repeated : (wrap == CUTOUT_CLAMP ? clamp(at, 0.0, 1.0) : mirrored);
    return min(uint(inside * float(size)), size - 1u);
}

uvec2 cutout_texel(vec2 at, uvec4 cutout) {
    return uvec2(cutout_along(at.x, cutout.y, cutout.w & 3u), cutout_along(at.y, cutout.z, cutout.w >> 2u));
}

#endif
