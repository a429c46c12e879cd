#pragma once

#include "tests/bench/transport/transport_bench.h"

namespace tessera::tools::bench {

// Whether Debian's `blender` is installed.
bool has_cycles();

// The same scene by Blender's Cycles: no clamping, adaptive sampling, denoising or light threshold, with as many bounces. Its
// materials are its own, so that it has references of its own, which are kept with the others. At the smallest, the largest
// and, if there are more, a middle number of samples. Error: why there is no curve (the program failed, the scene cannot be
// exported).
Expected<TransportCurve> measure_cycles(const BenchScene& scene, const TransportPlan& plan,
                                        const BenchProgress& progress, const std::stop_token& stop);

}  // namespace tessera::tools::bench
