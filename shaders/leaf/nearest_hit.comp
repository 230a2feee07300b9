#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require

// Distance to what each ray meets first, and the number of that triangle.
const bool ANY_HIT = false;
#include "trace.glsl"
