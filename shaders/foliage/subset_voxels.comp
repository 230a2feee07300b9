#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"
#include "dispatch.glsl"
#include "subset.glsl"

// Enters every generator into a hash table of the voxels of one size and counts the voxels. In
// the end also notes the table's place of each generator and the first generator of each place.
// Which generator stands in the table, and where, depends on the schedule; how many there are,
// and which comes first, does not.

layout(local_size_x = GROUP_1D) in;
layout(constant_id = 0) const uint FINAL = 0;
layout(set = 0, binding = 0, scalar) restrict readonly buffer Centres { vec4 centres[]; };
layout(set = 0, binding = 1, scalar) restrict readonly buffer Edges { uint edges[]; };
layout(set = 0, binding = 2, scalar) restrict buffer Search { SubsetSearch search; };
layout(set = 0, binding = 3, scalar) restrict buffer Table { uint table[]; };
layout(set = 0, binding = 4, scalar) restrict writeonly buffer Places { uint places[]; };
layout(set = 0, binding = 5, scalar) restrict buffer Leaders { uint leaders[]; };
layout(push_constant, scalar) uniform Push { SubsetVoxels push; };

void main() {
    uint i = flat_invocation();
    if (i >= push.count) {
        return;
    }
    uint edge = edges[FINAL != 0u ? search.high : (search.low + search.high) / 2u];
    uvec3 mine = voxel(centres[i].xyz, edge, push.shift);
    uint place = voxel_hash(mine) & push.table_mask;
    for (uint probe = 0u; probe < SUBSET_PROBES; ++probe) {
        uint other = atomicCompSwap(table[place], SUBSET_NONE, i);
        if (other == SUBSET_NONE) {
            atomicAdd(search.voxels, 1u);
            other = i;
        }
        if (other == i || voxel(centres[other].xyz, edge, push.shift) == mine) {
            if (FINAL != 0u) {
                places[i] = place;
                atomicMin(leaders[place], i);
            }
            return;
        }
        place = (place + 1u) & push.table_mask;
    }
    atomicAdd(search.lost, 1u);
}
