#pragma once

#include <cstddef>

namespace tessera::test {

// The operation of stand_in.cpp: the mean over (2 radius + 1)^2 pixels whose albedo and normal differ from those in the
// centre by no more than the range, component by component.
inline constexpr std::size_t StandInRadius = 2;
inline constexpr float StandInRange = 0.1f;

}  // namespace tessera::test
