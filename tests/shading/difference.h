#pragma once

#include <string>
#include <vector>

#include "tests/shading/cases.h"

namespace tessera::shading {

// One line of functions.inc.
struct SharedFunction {
    std::string call;
    double ordinary = 0.0, edges = 0.0;  // bounds, ulp
};
std::vector<SharedFunction> shared_functions();

struct Difference {
    double ulp = 0.0;  // of the largest component of the vector where both are farthest apart; infinite where
                       // one of both is no number, or bits that must not differ do
    std::size_t input = 0;
    std::string values;  // of both there, for messages
};

// The largest over all inputs. Numbers below 2^-126 count as 0: a device may flush them.
Difference largest_difference(const std::vector<Outputs>& a, const std::vector<Outputs>& b);

}  // namespace tessera::shading
