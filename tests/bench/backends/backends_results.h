#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace tessera::tools::bench {

// A measured quantity of a back-end. `scale`: from the stored unit (seconds, bytes, rays or samples per
// second) to the displayed unit.
struct Measure {
    std::string_view key, label, unit;
    double scale = 1.0;
};

inline constexpr std::array BackendMeasures{
    Measure{"primary_rays", "rays: primary", "Mrays/s", 1e-6},
    Measure{"shadow_rays", "rays: shadow", "Mrays/s", 1e-6},
    Measure{"bounce_rays", "rays: bounce", "Mrays/s", 1e-6},
    Measure{"samples", "paths: samples", "Msamples/s", 1e-6},
    Measure{"path_rays", "paths: rays", "Mrays/s", 1e-6},
    Measure{"build", "build", "ms", 1e3},
    Measure{"refit", "refit of a mesh", "ms", 1e3},
    Measure{"update", "update of a transform", "ms", 1e3},
    Measure{"build_to_picture", "build to picture", "ms", 1e3},
    Measure{"refit_to_picture", "refit to picture", "ms", 1e3},
    Measure{"update_to_picture", "update to picture", "ms", 1e3},
    Measure{"build_bytes", "upload: build", "MB", 1e-6},
    Measure{"refit_bytes", "upload: refit", "MB", 1e-6},
    Measure{"update_bytes", "upload: update", "MB", 1e-6},
};

// The measurements of one target on one scene, in the order of measurement.
class Measurements {
  public:
    void add(std::string_view key, double value) { values_[std::string(key)].push_back(value); }
    const std::vector<double>& all(std::string_view key) const;  // empty if not measured
    double median(std::string_view key) const;                   // 0 if not measured

  private:
    std::map<std::string, std::vector<double>> values_;
};

struct TargetResult {
    std::string name, kind;  // kind: of the back-end, with its device
    Measurements measured;
};

struct BackendsScene {
    std::string name, summary;
    std::uint64_t triangles = 0, instances = 0;
    std::vector<TargetResult> targets;
};

struct BackendsResults {
    std::string software;
    std::uint32_t threads = 0, width = 0, height = 0, rays = 0, repeat = 0;
    std::uint64_t spp = 0;
    double seconds = 0.0;
    std::vector<BackendsScene> scenes;
};

}  // namespace tessera::tools::bench
