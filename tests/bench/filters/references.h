#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <string>

#include "tests/bench/filters/errors.h"
#include "tests/bench/filters/sampler.h"

namespace tessera::tools::bench {

inline constexpr std::array<std::uint64_t, 2> ReferenceSeeds{1001, 2002};  // none is the films'

// Reference pictures as files that are read again as long as they mean the same picture: scene, camera, size,
// samples, seed, and bits of this renderer (a small film of the scene is part of the key).
class ReferenceCache {
  public:
    explicit ReferenceCache(std::filesystem::path folder) : folder_(std::move(folder)) {}

    // The film of `view` (radiance alone) as it was stored under this key. NotFound: never stored, or stored
    // under another key. InvalidInput: damaged.
    Expected<frame::FilmTile> load(const std::string& name, const std::string& key) const;
    void store(const std::string& name, const std::string& key, const frame::FilmTile& film) const;

  private:
    std::filesystem::path path(const std::string& name) const { return folder_ / (name + ".exr"); }
    std::filesystem::path folder_;
};

struct ReferenceRequest {
    std::string scene;    // for file names
    std::string content;  // hash of the scene
    view::View view;      // its seed and channels do not count
    std::uint64_t spp = 4096;
};
struct ReferenceProgress {
    std::function<void(const std::string&)> say;
    std::function<void(const std::string&)> warn;
};

// Two independent references, read or rendered. Nothing when it was stopped; what is finished is kept.
std::optional<ReferencePair> references(const ReferenceRequest& request, const Sampler& sampler,
                                        const ReferenceCache& cache, const ReferenceProgress& progress,
                                        const std::stop_token& stop);

}  // namespace tessera::tools::bench
