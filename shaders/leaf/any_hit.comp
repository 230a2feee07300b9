#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require

// Whether each ray meets anything: bit `place` of a word for the rays of an invocation.
const bool ANY_HIT = true;
#include "trace.glsl"
