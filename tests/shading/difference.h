#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "tests/shading/cases.h"

namespace tessera::shading {

// One line of a list.
struct SharedFunction {
    std::string call;
    double ordinary, edges;  // bounds, ulp
    bool decides;  // branches on rounded numbers: 1 ordinary input in 200 and 1 edge in 50 may differ by more
};
std::vector<SharedFunction> functions_of(std::uint32_t list);

struct Difference {
    double ulp = 0.0;       // the largest one that counts
    std::size_t input = 0;  // where it is
    std::string values;     // of both there, for messages
};

// Of two results: in ulp of the largest component of the vector where they are farthest apart; infinite where
// only one is a number, or where bits differ that must not. Numbers below 2^-112 count as 0: a device may
// flush them, or smaller ones that they are calculated from.
double difference(const Outputs& a, const Outputs& b);

// The largest difference of all results, ignoring the `outside` worst.
Difference largest_difference(std::span<const Outputs> a, std::span<const Outputs> b, std::size_t outside);

std::size_t count_beyond(std::span<const Outputs> a, std::span<const Outputs> b, double bound);

}  // namespace tessera::shading
