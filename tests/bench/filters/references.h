#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <string>

#include "tests/bench/filters/errors.h"
#include "tests/bench/filters/sampler.h"

namespace tessera::tools::bench {

inline constexpr std::array<std::uint64_t, 2> ReferenceSeeds{1001, 2002};  // differ from the film's seed

// Cache of reference pictures as files. The key consists of scene, camera, size, samples, seed, and the
// renderer's bits (the hash of a small film of the scene).
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
    view::View view;      // its seed and channels are ignored
    std::uint64_t spp = 4096;
};
struct ReferenceProgress {
    std::function<void(const std::string&)> say;
    std::function<void(const std::string&)> warn;
};

// Two independent references, read or rendered. Empty when stopped; finished references are kept.
std::optional<ReferencePair> references(const ReferenceRequest& request, const Sampler& sampler,
                                        const ReferenceCache& cache, const ReferenceProgress& progress,
                                        const std::stop_token& stop);

}  // namespace tessera::tools::bench
