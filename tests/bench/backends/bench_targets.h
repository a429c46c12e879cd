#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "mediator/backend/backend.h"
#include "mediator/shading/ray_query.h"

// Benchmark targets: whole back-ends through their interface, and their ray traversal alone.
namespace tessera::bench {

enum class RayQueryKind { Closest, Any };

// Bare traversal through one scene: no paths, no shading. Rays are traced with all resources of the target:
// cores or a device.
class RayCaster {
  public:
    virtual ~RayCaster() = default;

    // Prepares to trace these rays repeatedly.
    virtual void take(std::span<const shading::RayQuery> rays, RayQueryKind kind) = 0;
    virtual void cast() = 0;  // synchronous
    // Hits of the last cast, by ray; instance = NoInstance for misses. Only the instance is valid for
    // RayQueryKind::Any.
    virtual std::vector<shading::Hit> hits() const = 0;
};

struct BenchTarget {
    std::string name;
    std::string summary;
    bool chooses_device = false;  // whether BackendSettings::device is used
    // Both throw Error when they cannot start.
    std::function<std::unique_ptr<backend::Backend>(const backend::BackendSettings&)> make_backend;
    std::function<std::unique_ptr<RayCaster>(const backend::BackendSettings&,
                                             const scene::ChangeList& snapshot)>
        make_caster;
};

// The targets that were built; the others are compared with the first.
std::vector<BenchTarget> bench_targets();

}  // namespace tessera::bench
