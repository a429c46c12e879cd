#pragma once

#include <string>
#include <vector>

#include "backends/embree/kernel.h"
#include "mediator/backend/sky_cells.h"
#include "mediator/backend/tables/tables.h"
#include "mediator/shading/paths.h"
#include "mediator/view/view.h"

namespace tessera::embree {

using shading::PathSample;

// Light sampling strategies; all have the same expectation. Only tests use others than Both.
enum class Strategy : std::uint32_t {
    Both = shading::StrategyBoth,
    LightsOnly = shading::StrategyLightsOnly,
    BsdfOnly = shading::StrategyBsdfOnly,
    FlightOnly = shading::StrategyFlightOnly,
    EquiangularOnly = shading::StrategyEquiangularOnly,
};

// Traces the samples of one view (mediator/shading/trace.h), with Embree's rays. Stateless between samples:
// each is a pure function of (scene, view, pixel, index). The tables must outlive it at the same address.
class PathTracer {
  public:
    PathTracer(const backend::SceneTables& tables, RTCScene top, const view::View& view,
               Strategy strategy = Strategy::Both);
    PathTracer(const PathTracer&) = delete;  // its view points to its members
    PathTracer& operator=(const PathTracer&) = delete;

    // Any thread. `rays` is raised by the rays traced; `path_log`, if given, gets a line per vertex.
    PathSample trace(std::uint32_t x, std::uint32_t y, std::uint64_t sample, std::uint64_t& rays,
                     std::vector<std::string>* path_log = nullptr) const;

    // The sky cells of the view; nullopt: stopped. `threads`: 0 = all cores.
    std::optional<backend::SkyCells> make_sky_cells(std::uint32_t threads, const std::stop_token& stop) const;
    // Samples from `first_sample` on use them. They must outlive it at the same address.
    void use_sky_cells(const backend::SkyCells& cells, std::uint32_t first_sample) {
        cells.use_in(view_, first_sample);
    }

    const shading::View& view() const { return view_; }
    // Selected by the features of the scene and the view. Tests may set another one, which must support all
    // of them.
    const Kernel& kernel() const { return *kernel_; }
    void set_kernel(const Kernel& kernel) { kernel_ = &kernel; }

  private:
    const backend::SceneTables& tables_;
    shading::Scene scene_;
    std::vector<shading::Affine3x4> camera_keys_;
    shading::View view_;
    RTCScene top_;
    const Kernel* kernel_;
};

}  // namespace tessera::embree
