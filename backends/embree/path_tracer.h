#pragma once

#include <string>
#include <vector>

#include "backends/embree/camera.h"
#include "backends/embree/transport.h"

namespace tessera::embree {

// Traces the samples of one view. Stateless between samples: each is a pure function of (scene, view, pixel,
// index). Unidirectional; Russian roulette from the fourth vertex on, by the largest component of the
// throughput. With the renderer Whitted, see whitted.h.
class PathTracer {
  public:
    PathTracer(const SceneTables& tables, RTCScene scene, const view::View& view,
               Strategy strategy = Strategy::Both);

    // Any thread. `rays` is raised by the rays traced; `story`, if given, gets a line per vertex.
    PathSample trace(std::uint32_t x, std::uint32_t y, std::uint64_t sample, std::uint64_t& rays,
                     std::vector<std::string>* story = nullptr) const;

  private:
    void trace_path(Path& path, Ray ray, Hit hit) const;

    RayCaster rays_;
    view::View view_;
    Camera camera_;
    Transport transport_;
    std::uint64_t max_scatterings_;
    bool wants_light_;  // otherwise a path ends where its features are known
};

}  // namespace tessera::embree
