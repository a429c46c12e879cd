#include "backends/vulkan/bvh/tree_serialization.h"

#include <bit>
#include <cstring>

#include "backends/vulkan/bvh/wide_tree_writer.h"

namespace tessera::vulkan {

namespace {

using shading::BvhLeafTriangles;
using shading::BvhNode;
using shading::BvhWidth;

struct Header {
    double cost = 0.0;
    std::uint32_t nodes = 0, primitives = 0;
};
static_assert(sizeof(Header) == 16, "the serialized header has no padding");

// A node in a word: 4 bits count of inner children, then 2 bits each slot, how many triangles its leaf has.
constexpr std::uint32_t SlotShift = 4;

std::uint32_t word_of(const BvhNode& node) {
    std::uint32_t word = node.frame >> 24u;
    for (std::uint32_t slot = 0; slot < BvhWidth; ++slot) {
        const std::uint32_t leaf = node.leaves[slot / 4] >> (8u * (slot % 4)) & 0xffu;
        word |= static_cast<std::uint32_t>(std::popcount(leaf >> 5u)) << (SlotShift + 2 * slot);
    }
    return word;
}

void write_words(const WideTree& tree, std::uint32_t at, std::vector<std::uint32_t>& words) {
    const BvhNode& node = tree.nodes[at];
    words.push_back(word_of(node));
    for (std::uint32_t i = 0; i < node.frame >> 24u; ++i) write_words(tree, node.first_child + i, words);
}

// Reads words and primitives with bounds checks.
class Reader {
  public:
    Reader(std::span<const std::uint32_t> words, std::span<const std::uint32_t> primitives)
        : words_(words), primitives_(primitives) {}

    std::optional<WideTree> run() {
        if (!read(0, 1) || !words_.empty() || !primitives_.empty()) return std::nullopt;
        return rows_.take();
    }

  private:
    bool read(std::uint32_t at, std::uint32_t depth) {
        if (words_.empty() || depth > shading::BvhMeshDepth) return false;
        const std::uint32_t word = words_.front();
        words_ = words_.subspan(1);
        const std::uint32_t inner_count = word & 15u;
        // These nodes are still to be read: at most as many as words are left.
        if (inner_count > BvhWidth || inner_count > words_.size()) return false;
        const std::uint32_t first = rows_.open_node(at, depth, inner_count);
        for (std::uint32_t slot = 0; slot < BvhWidth; ++slot) {
            const std::uint32_t count = word >> (SlotShift + 2 * slot) & 3u;
            if (count == 0) continue;
            if (slot < inner_count || count > primitives_.size()) return false;
            rows_.add_leaf(at, slot, primitives_.first(count));
            primitives_ = primitives_.subspan(count);
        }
        for (std::uint32_t slot = 0; slot < inner_count; ++slot) {
            if (!read(first + slot, depth + 1)) return false;
        }
        return true;
    }

    std::span<const std::uint32_t> words_, primitives_;  // the remaining ones
    WideTreeWriter rows_{Level::Mesh};
};
static_assert(BvhLeafTriangles == 3, "the count of a leaf takes 2 bits, all values of which are valid");

bool names_each_once(std::span<const std::uint32_t> primitives, std::size_t triangle_count) {
    std::vector<char> named(triangle_count);
    for (const std::uint32_t triangle : primitives) {
        if (triangle >= triangle_count || named[triangle] != 0) return false;
        named[triangle] = 1;
    }
    return true;
}

}  // namespace

std::vector<std::byte> serialize_tree(const WideTree& tree) {
    std::vector<std::uint32_t> words;
    words.reserve(tree.nodes.size());
    write_words(tree, 0, words);
    const Header header{.cost = tree.cost,
                        .nodes = static_cast<std::uint32_t>(words.size()),
                        .primitives = static_cast<std::uint32_t>(tree.primitives.size())};
    const auto start = std::as_bytes(std::span(&header, 1));
    const auto shape = std::as_bytes(std::span(words));
    const auto row = std::as_bytes(std::span(tree.primitives));
    std::vector<std::byte> bytes;
    bytes.reserve(start.size() + shape.size() + row.size());
    for (const auto part : {start, shape, row}) bytes.insert(bytes.end(), part.begin(), part.end());
    return bytes;
}

std::optional<WideTree> deserialize_tree(std::span<const std::byte> bytes, const MeshData& mesh,
                                         const TraversalCosts& costs) {
    Header header;
    if (bytes.size() < sizeof header || bytes.size() % sizeof(std::uint32_t) != 0) return std::nullopt;
    std::memcpy(&header, bytes.data(), sizeof header);
    bytes = bytes.subspan(sizeof header);
    std::vector<std::uint32_t> rows(bytes.size() / sizeof(std::uint32_t));
    if (rows.empty() || std::uint64_t{header.nodes} + header.primitives != rows.size()) return std::nullopt;
    std::memcpy(rows.data(), bytes.data(), bytes.size());
    const std::span<const std::uint32_t> all(rows);
    const auto primitives = all.subspan(header.nodes);
    if (!names_each_once(primitives, mesh.triangles.size())) return std::nullopt;
    std::optional<WideTree> tree = Reader(all.first(header.nodes), primitives).run();
    // False if a triangle is missing.
    if (!tree || !refit_mesh(*tree, mesh, header.cost, costs) || tree->cost != header.cost) {
        return std::nullopt;
    }
    return tree;
}

}  // namespace tessera::vulkan
