#ifndef DISPATCH_GLSL
#define DISPATCH_GLSL

// Index of this invocation in a one-dimensional dispatch. The host folds x over y when there
// are more groups than one dimension of the device allows.
uint flat_invocation() {
    uint group = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
    return group * gl_WorkGroupSize.x + gl_LocalInvocationID.x;
}

#endif
