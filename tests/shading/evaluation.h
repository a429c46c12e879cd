#pragma once

#include <cstddef>
#include <cstdint>

namespace tessera {

// The lists in functions/, by number; shading.comp and CMakeLists.txt count the same.
inline constexpr const char* FunctionLists[] = {
    "numbers",  "lobes",   "textures",        "surfaces", "lights",    "found", "steps",
    "branches", "samples", "surface_shaders", "views",    "materials", "media"};
inline constexpr std::uint32_t FunctionListCount = 13;

// Results of all functions of a list: from shading::TestScene and `count` shading::Inputs to
// shading::Outputs, those of one function after those of the other.
using Evaluate = void(std::uint32_t list, const void* test_scene, const void* inputs, std::size_t count,
                      void* outputs);

Evaluate evaluate_plain;  // as C++ is compiled everywhere
// With products and sums contracted to one rounding, as a device may do where they are not PRECISE.
Evaluate evaluate_contracted;

}  // namespace tessera
