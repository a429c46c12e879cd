#version 460
#extension GL_GOOGLE_include_directive : require
layout(set = 0, binding = 0) uniform usamplerBuffer pool_texels;
#define BVH_TEXELS pool_texels
#include "backends/vulkan/shaders/trace.glsl"
