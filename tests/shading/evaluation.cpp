#include "tests/shading/evaluation.h"

#include "tests/shading/cases.h"

// CMakeLists.txt compiles this file twice, the second time with other names for this function and for what it
// calls, so that the linker cannot take one for the other.
#ifndef EVALUATE
#define EVALUATE evaluate_plain
#endif

namespace tessera {

void EVALUATE(std::uint32_t function, const void* inputs, void* outputs, std::size_t count) {
    const auto* x = static_cast<const shading::Inputs*>(inputs);
    auto* y = static_cast<shading::Outputs*>(outputs);
    for (std::size_t i = 0; i < count; ++i) y[i] = shading::evaluate(function, x[i]);
}

}  // namespace tessera
