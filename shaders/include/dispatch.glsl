#ifndef DISPATCH_GLSL
#define DISPATCH_GLSL

// Index of this invocation in a one-dimensional dispatch. The host folds x over y when there
// are more groups than one dimension of the device allows. A macro, because gl_WorkGroupSize
// must not be used before the shader declares its local size.
#define flat_invocation() \
    ((gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * gl_WorkGroupSize.x + gl_LocalInvocationID.x)

#endif
