#pragma once

#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "backends/vulkan/bvh/mesh_bvh.h"
#include "mediator/base/disk_cache.h"

namespace tessera::vulkan {

// Of the arrays in MeshData.
struct MeshHashes {
    Hash256 positions, triangles;
};

// Built trees of meshes on disk, by the content of the mesh and how they are built, so that a node that
// starts again, or whose device was lost, need not build them again (Schwenk F61). What is read is checked as
// `restored` says before anything walks it. Small meshes are not kept. Thread-safe.
class TreeCache final {
  public:
    // An empty folder: nothing is kept. Never more than `byte_limit` is.
    explicit TreeCache(std::filesystem::path folder, std::uint64_t byte_limit = ByteLimit);

    std::optional<WideTree> load(const MeshData& mesh, const MeshHashes& hashes,
                                 const TraversalCosts& costs = {});
    void save(const WideTree& tree, const MeshHashes& hashes, const TraversalCosts& costs = {});

    // What went wrong since the last call, a phrase each.
    std::vector<std::string> take_notes();

    // A tree takes 4.5 bytes a triangle: some 50 million.
    static constexpr std::uint64_t ByteLimit = std::uint64_t{256} << 20;

    // On two cores, building took 3 ms for 4,000 triangles, 16 ms for 16,000 and 1.2 s for a million, loading
    // 0.2, 0.7 and 112 ms; saving took up to 4 ms for any mesh of up to 16,000 triangles, and 13 ms for the
    // million. From here on the first load makes up for that.
    static constexpr std::size_t FewestTriangles = 10'000;

  private:
    DiskCache files_;
    std::mutex mutex_;  // protects what follows
    std::vector<std::string> notes_;
};

}  // namespace tessera::vulkan
