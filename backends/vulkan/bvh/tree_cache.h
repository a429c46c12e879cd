#pragma once

#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "backends/vulkan/bvh/mesh_bvh.h"
#include "mediator/base/disk_cache.h"

namespace tessera::vulkan {

// Content hashes of the arrays in MeshData.
struct MeshHashes {
    Hash256 positions, triangles;
};

// A disk cache of mesh BVHs, keyed by mesh content and build settings, so that they need not be rebuilt when a
// node restarts or its device was lost (Schwenk F61). deserialize_tree() validates what is read. Small meshes
// are not cached. Thread-safe.
class TreeCache final {
  public:
    // An empty folder disables the cache. It never takes more than `byte_limit`.
    explicit TreeCache(std::filesystem::path folder, std::uint64_t byte_limit = ByteLimit);

    std::optional<WideTree> load(const MeshData& mesh, const MeshHashes& hashes,
                                 const TraversalCosts& costs = {});
    void save(const WideTree& tree, const MeshHashes& hashes, const TraversalCosts& costs = {});

    // Problems since the last call, one phrase each.
    std::vector<std::string> take_notes();

    // A tree takes 4.5 bytes per triangle: enough for some 50 million triangles.
    static constexpr std::uint64_t ByteLimit = std::uint64_t{256} << 20;

    // On two cores, building took 3 ms for 4,000 triangles, 16 ms for 16,000 and 1.2 s for a million, loading
    // 0.2, 0.7 and 112 ms; saving took up to 4 ms for any mesh of up to 16,000 triangles, and 13 ms for the
    // million. From this size on the first load saves more than saving cost.
    static constexpr std::size_t MinTriangles = 10'000;

  private:
    DiskCache files_;
    std::mutex mutex_;  // protects the following
    std::vector<std::string> notes_;
};

}  // namespace tessera::vulkan
