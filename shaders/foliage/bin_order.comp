#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"
#include "dispatch.glsl"

// Sorts the numbers of the points inside every bin ascending, so that sums over a bin have one
// order whatever the atomics of the count did. Heap sort: n log n also where all points coincide.

layout(local_size_x = GROUP_1D) in;
layout(set = 0, binding = 0, scalar) restrict readonly buffer BinFirst { uint bin_first[]; };
layout(set = 0, binding = 1, scalar) restrict buffer Sorted { uint sorted[]; };
layout(push_constant, scalar) uniform Push { BinPoints push; };

// Moves `value` down from `hole` in the heap [first, first + count).
void sift(uint first, uint count, uint hole, uint value) {
    uint child = 2u * hole + 1u;
    while (child < count) {
        uint largest = sorted[first + child];
        if (child + 1u < count) {
            uint other = sorted[first + child + 1u];
            if (other > largest) {
                largest = other;
                ++child;
            }
        }
        if (largest <= value) {
            break;
        }
        sorted[first + hole] = largest;
        hole = child;
        child = 2u * hole + 1u;
    }
    sorted[first + hole] = value;
}

void main() {
    uint bin = flat_invocation();
    if (bin >= push.bins.x * push.bins.y * push.bins.z) {
        return;
    }
    uint first = bin_first[bin];
    uint count = bin_first[bin + 1u] - first;
    if (count < 2u) {
        return;
    }
    for (uint i = count / 2u; i > 0u; --i) {
        sift(first, count, i - 1u, sorted[first + i - 1u]);
    }
    for (uint end = count - 1u; end > 0u; --end) {
        uint value = sorted[first + end];
        sorted[first + end] = sorted[first];
        sift(first, end, 0u, value);
    }
}
