#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"

// What thresholds and widths are multiplied by in each pixel (Deussen and Strothotte 2000, figure
// 4 c): programs of a stack, of the buffers of what is seen there.

layout(local_size_x = 8, local_size_y = 8) in;
layout(set = 0, binding = 0, scalar) restrict readonly buffer Frame { InkFrame frame; };
layout(set = 0, binding = 1, scalar) restrict readonly buffer Steps { PaperOp steps[]; };
layout(set = 0, binding = 2, scalar) restrict readonly buffer Traits { PaperTrait traits[]; };
layout(set = 0, binding = 3) uniform sampler2D foliage_depth;
layout(set = 0, binding = 4) uniform sampler2D foliage_number;
layout(set = 0, binding = 5) uniform sampler2D stem_depth;
layout(set = 0, binding = 6) uniform sampler2D stem_normal;
layout(set = 0, binding = 7) uniform sampler2D shadow_map;
layout(set = 0, binding = 8) uniform sampler2D mask_map;
layout(set = 0, binding = 9, rgba16f) uniform restrict writeonly image2D factors;
layout(push_constant, scalar) uniform Push { PaperModulate push; };

float inputs[PAPER_VARIABLES];

float one_of(uint code, float a) {
    switch (code) {
        case PAPER_NEG: return -a;
        case PAPER_NOT: return a == 0.0 ? 1.0 : 0.0;
        case PAPER_ABS: return abs(a);
        case PAPER_SQRT: return sqrt(max(a, 0.0));
        case PAPER_SIN: return sin(a);
        case PAPER_COS: return cos(a);
        case PAPER_EXP: return exp(min(a, 50.0));
        case PAPER_LOG: return a > 0.0 ? log(a) : 0.0;
        case PAPER_FLOOR: return floor(a);
        default: return a - floor(a);
    }
}

float power(float a, float b) {
    if (b == 0.0) {
        return 1.0;
    }
    if (a == 0.0) {
        return 0.0;
    }
    float size = exp(min(b * log(abs(a)), 50.0));
    bool whole = b == floor(b);
    bool odd = b - 2.0 * floor(0.5 * b) == 1.0;
    return a > 0.0 ? size : !whole ? 0.0 : odd ? -size : size;
}

float two_of(uint code, float a, float b) {
    switch (code) {
        case PAPER_ADD: return a + b;
        case PAPER_SUB: return a - b;
        case PAPER_MUL: return a * b;
        case PAPER_DIV: return b == 0.0 ? 0.0 : a / b;
        case PAPER_MOD: return b == 0.0 ? 0.0 : a - b * floor(a / b);
        case PAPER_POW: return power(a, b);
        case PAPER_MIN: return min(a, b);
        case PAPER_MAX: return max(a, b);
        case PAPER_LESS: return a < b ? 1.0 : 0.0;
        default: return a > b ? 1.0 : 0.0;
    }
}

float three_of(uint code, float a, float b, float c) {
    switch (code) {
        case PAPER_CLAMP: return min(max(a, b), c);
        case PAPER_MIX: return a + (b - a) * c;
        case PAPER_SMOOTH:
            float t = b == a ? (c < a ? 0.0 : 1.0) : clamp((c - a) / (b - a), 0.0, 1.0);
            return t * t * (3.0 - 2.0 * t);
        default: return a != 0.0 ? b : c;
    }
}

// The value of the program of the steps from `first` to `end`; without steps 1.
float value_of(uint first, uint end) {
    float stack[PAPER_STACK];
    uint top = 0u;
    for (uint i = first; i < end; i++) {
        PaperOp op = steps[i];
        float value;
        if (op.code == PAPER_NUMBER) {
            value = op.value;
        } else if (op.code == PAPER_VARIABLE) {
            value = inputs[uint(op.value)];
        } else if (op.code <= PAPER_FRACT) {
            top -= 1u;
            value = one_of(op.code, stack[top]);
        } else if (op.code <= PAPER_GREATER) {
            top -= 2u;
            value = two_of(op.code, stack[top], stack[top + 1u]);
        } else {
            top -= 3u;
            value = three_of(op.code, stack[top], stack[top + 1u], stack[top + 2u]);
        }
        stack[top] = clamp(value, -PAPER_LARGEST, PAPER_LARGEST);
        top += 1u;
    }
    return first < end ? stack[0] : 1.0;
}

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (pixel.x >= int(push.width) || pixel.y >= int(push.height)) {
        return;
    }
    float foliage = texelFetch(foliage_depth, pixel, 0).r;
    float stem = texelFetch(stem_depth, pixel, 0).r;
    vec2 factor = vec2(1.0);
    if (foliage > 0.0 || stem > 0.0) {
        bool leaf = foliage > 0.0 && (stem <= 0.0 || foliage <= stem);
        vec4 normal = texelFetch(stem_normal, pixel, 0);
        float number = 0.0;
        float object = 0.0;
        if (leaf) {
            number = texelFetch(foliage_number, pixel, 0).r;
            PaperTrait of = traits[min(uint(number), uint(traits.length())) - 1u];
            object = of.object;
            vec3 n = vec3(dot(of.normal, frame.right), dot(of.normal, frame.up), -dot(of.normal, frame.forward));
            // Leaves have two sides.
            float light = push.ambient + (1.0 - push.ambient) * abs(dot(of.normal, frame.to_sun));
            normal = vec4(n.z < 0.0 ? -n : n, light);
        }
        float share = ((leaf ? foliage : stem) - push.nearest) / (push.farthest - push.nearest);
        vec4 masks = texelFetch(mask_map, min(pixel, textureSize(mask_map, 0) - 1), 0);
        inputs[0] = (float(pixel.x) + 0.5) / float(push.width);
        inputs[1] = 1.0 - (float(pixel.y) + 0.5) / float(push.height);
        inputs[2] = push.near + share * (push.far - push.near);
        inputs[3] = number;
        inputs[4] = object;
        inputs[5] = texelFetch(shadow_map, pixel, 0).r;
        inputs[6] = normal.w;
        inputs[7] = normal.x;
        inputs[8] = normal.y;
        inputs[9] = normal.z;
        inputs[10] = masks.x;
        inputs[11] = masks.y;
        inputs[12] = masks.z;
        inputs[13] = masks.w;
        uvec4 ends = push.ends;
        uvec3 part = leaf ? uvec3(0u, ends.x, ends.y) : uvec3(ends.y, ends.z, ends.w);
        factor = vec2(value_of(part.x, part.y), value_of(part.y, part.z));
        factor = clamp(factor, vec2(0.0), vec2(PAPER_FACTOR, PAPER_WIDER));
    }
    imageStore(factors, pixel, vec4(factor, 0.0, 0.0));
}
