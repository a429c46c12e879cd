#pragma once

#include <vector>

#include "tests/shading/cases.h"

namespace tessera::shading {

enum class InputSet {
    Ordinary,  // random, where functions are not steep: roughness from 0.3, cosines from 0.1
    Edges      // edge cases in any combination: grazing and normal directions, near mirrors, alpha =
               // MinAlpha, exact 0 and 1, tiny and huge
};

// The same numbers on every machine.
std::vector<Inputs> make_inputs(InputSet set, std::size_t count);

}  // namespace tessera::shading
