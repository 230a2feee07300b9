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

// What a ray meets of a pair of triangles.
struct Meeting {
    // Whether anything, and whether both.
    bool any;
    bool both;
    // Distance and number (0 or 1) of the nearer one.
    float t;
    uint which;
    // Weights of a or d, of b and of c.
    vec3 weights;
};

ivec2 ray_place(uint texel) {
    return ivec2(texel & ((1u << RAY_COLUMN_BITS) - 1u), texel >> RAY_COLUMN_BITS);
}

// A texel of an image whose texels are numbered row by row. These are storage images: Mesa's
// software driver spends most of a sampled fetch on levels of detail. A macro, because
// a function would need one variant for each format.
#define ray_texel(image, texel) imageLoad(image, ray_place(texel))

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

// Which side of the edge from a to b the ray passes. Exactly the opposite from b to a.
float edge(vec2 a, vec2 b) {
    precise float e = b.x * a.y - b.y * a.x;
    return e;
}

bool same_side(float u, float v, float w) {
    float least = u < v ? u : v;
    float most = u > v ? u : v;
    least = least < w ? least : w;
    most = most > w ? most : w;
    return least >= 0.0 || most <= 0.0;
}

// The triangles abc and dbc before `t_max`; either side is hit. `wanted` has a bit for each. The
// test of Woop, Benthin and Wald 2013, Watertight Ray/Triangle Intersection: the corners are
// moved to the ray's frame, each by itself, and the signs of the edge functions there decide. A
// rounded difference of products may be 0, but never has the wrong sign, and a 0 counts as a hit
// for both triangles of an edge: no ray slips through between them.
Meeting intersect(Ray ray, vec3 a, vec3 b, vec3 c, vec3 d, float t_max, uint wanted) {
    precise vec3 pa = turned(a - ray.origin, ray.axis);
    precise vec3 pb = turned(b - ray.origin, ray.axis);
    precise vec3 pc = turned(c - ray.origin, ray.axis);
    precise vec3 pd = turned(d - ray.origin, ray.axis);
    precise vec2 qa = pa.xy - ray.shear.xy * pa.z;
    precise vec2 qb = pb.xy - ray.shear.xy * pb.z;
    precise vec2 qc = pc.xy - ray.shear.xy * pc.z;
    precise vec2 qd = pd.xy - ray.shear.xy * pd.z;
    float bc = edge(qb, qc);
    float ca = edge(qc, qa);
    float ab = edge(qa, qb);
    float cd = edge(qc, qd);
    float db = edge(qd, qb);
    precise float sum = bc + ca + ab;
    precise float sum_d = bc + cd + db;
    float t = ray.shear.z * (bc * pa.z + ca * pb.z + ab * pc.z) / sum;
    float t_d = ray.shear.z * (bc * pd.z + cd * pb.z + db * pc.z) / sum_d;
    bool first = same_side(bc, ca, ab) && sum != 0.0 && t > 0.0 && t < t_max && (wanted & 1u) != 0u;
    bool second = same_side(bc, cd, db) && sum_d != 0.0 && t_d > 0.0 && t_d < t_max && (wanted & 2u) != 0u;
    bool take_second = second && !(first && t <= t_d);
    Meeting meeting;
    meeting.any = first || second;
    meeting.both = first && second;
    meeting.t = take_second ? t_d : t;
    meeting.which = take_second ? 1u : 0u;
    meeting.weights = take_second ? vec3(bc, cd, db) / sum_d : vec3(bc, ca, ab) / sum;
    return meeting;
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

// Byte k of a word as 1 + byte / 256: cheaper than a conversion from integers.
vec3 grid_place(uvec3 words, uint k) {
    uvec3 bits = k == 0u ? words << 15u : (k == 1u ? words << 7u : (k == 2u ? words >> 1u : words >> 9u));
    return uintBitsToFloat((bits & 0x7f8000u) | 0x3f800000u);
}

// Which children of a node the ray may meet before `t_max`: bit 24 + place of a child that is a node,
// bits of the objects of the others.
uint open_boxes(Ray ray, float t_max, uvec4 head, uvec2 about, uvec4 xy, uvec4 zx, uvec4 yz) {
    uvec3 exponents = uvec3(head.w & 0xffu, (head.w >> 8u) & 0xffu, (head.w >> 16u) & 0xffu);
    // A step of the grid, times 256.
    vec3 slope = 256.0 * uintBitsToFloat(exponents << 23u) * ray.inverse;
    vec3 start = (uintBitsToFloat(head.xyz) - ray.origin) * ray.inverse - slope;
    bvec3 back = lessThan(ray.inverse, vec3(0.0));
    // Bytes of the near and the far planes of the eight children.
    uvec2 near_x = back.x ? zx.zw : xy.xy;
    uvec2 far_x = back.x ? xy.xy : zx.zw;
    uvec2 near_y = back.y ? yz.xy : xy.zw;
    uvec2 far_y = back.y ? xy.zw : yz.xy;
    uvec2 near_z = back.z ? yz.zw : zx.xy;
    uvec2 far_z = back.z ? zx.xy : yz.zw;
    uint waits = 0u;
    int end = floatBitsToInt(t_max);
    [[unroll]] for (uint half_of = 0u; half_of < 2u; ++half_of) {
        uvec3 near_bytes = uvec3(near_x[half_of], near_y[half_of], near_z[half_of]);
        uvec3 far_bytes = uvec3(far_x[half_of], far_y[half_of], far_z[half_of]);
        [[unroll]] for (uint k = 0u; k < 4u; ++k) {
            // As integers: the order is that of floats from 0 up, and what is below 0 stays below.
            ivec3 near = floatBitsToInt(slope * grid_place(near_bytes, k) + start);
            ivec3 far = floatBitsToInt(slope * grid_place(far_bytes, k) + start);
            int enter = max(max(near.x, near.y), max(near.z, 0));
            int leave = min(min(far.x, far.y), min(far.z, end));
            uint child = about[half_of] >> (8u * k);
            waits |= enter <= leave ? (child >> 5u & 7u) << (child & 31u) : 0u;
        }
    }
    return waits;
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
