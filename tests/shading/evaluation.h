#pragma once

#include <cstddef>
#include <cstdint>

namespace tessera {

// Results of one line of functions.inc: shading::Inputs to shading::Outputs, as many as `count`.
using Evaluate = void(std::uint32_t function, const void* inputs, void* outputs, std::size_t count);

Evaluate evaluate_plain;  // as C++ is compiled everywhere
// With products and sums contracted to one rounding, as a device may do where they are not PRECISE.
Evaluate evaluate_contracted;

}  // namespace tessera
