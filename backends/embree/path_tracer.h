#pragma once

#include <string>
#include <vector>

#include "backends/embree/scene_tables.h"
#include "mediator/shading/sobol.h"
#include "mediator/view/view.h"

namespace tessera::embree {

// What one sample found.
struct PathSample {
    glm::vec3 direct{0.0f};                // light after at most one scattering
    glm::vec3 indirect{0.0f};              // the rest
    glm::vec3 albedo{0.0f}, normal{0.0f};  // of the first hit
    float depth = 0.0f;                    // along the view axis; +inf: nothing hit
    std::uint32_t object = 0;
};

// How light is found; the estimates agree in expectation. Only tests choose other than Both.
enum class Strategy { Both, LightsOnly, BsdfOnly };

// Traces the samples of one view. Stateless between samples: each is a pure function of (scene, view, pixel,
// index). Unidirectional, next-event estimation with one light sample per vertex, combined with BSDF sampling
// by the power heuristic (Veach 1997); Russian roulette from the fourth vertex on, by the largest component
// of the throughput.
class PathTracer {
  public:
    PathTracer(const SceneTables& tables, RTCScene scene, const view::View& view,
               Strategy strategy = Strategy::Both);

    // Any thread. `rays` is raised by the rays traced; `story`, if given, gets a line per vertex.
    PathSample trace(std::uint32_t x, std::uint32_t y, std::uint64_t sample, std::uint64_t& rays,
                     std::vector<std::string>* story = nullptr) const;

  private:
    struct Ray {
        glm::vec3 origin, direction;
    };
    struct Path;

    Ray camera_ray(std::uint32_t x, std::uint32_t y, const glm::vec2& u) const;
    bool intersect(const Ray& ray, const Path& path, RTCHit& hit, float& distance) const;
    bool occluded(const glm::vec3& origin, const glm::vec3& to_target, float far, const Path& path) const;
    void add_sky(Path& path, const Ray& ray) const;
    void add_emission(Path& path, const Ray& ray, const struct Surface& surface) const;
    void add_lights(Path& path, const struct Surface& surface, const glm::vec3& out) const;
    bool scatter(Path& path, const struct Surface& surface, const glm::vec3& out, Ray& ray) const;

    const SceneTables& tables_;
    RTCScene scene_;
    view::View view_;
    Strategy strategy_;
    glm::vec3 eye_{0.0f}, right_{0.0f}, up_{0.0f}, forward_{0.0f};
};

}  // namespace tessera::embree
