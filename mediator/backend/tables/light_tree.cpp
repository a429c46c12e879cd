#include "mediator/backend/tables/light_tree.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>
#include <numeric>

namespace tessera::backend {

namespace {

using std::numbers::pi;
constexpr double Infinity = std::numeric_limits<double>::infinity();

struct LightBounds {
    glm::dvec3 low{Infinity}, high{-Infinity};

    void add(const glm::dvec3& l, const glm::dvec3& h) {
        low = glm::min(low, l);
        high = glm::max(high, h);
    }
    double extent2() const {
        const glm::dvec3 size = high - low;
        return glm::dot(size, size);
    }
};

// Aggregate of the emitters of a node.
struct Group {
    LightBounds bounds;
    glm::dvec3 axis{0.0};
    double spread = 0.0, emission_angle = 0.0, power = 0.0;
    bool two_sided = false, is_area = false;
};

// v rotated about `axis`, a unit vector perpendicular to v.
glm::dvec3 rotated(const glm::dvec3& v, const glm::dvec3& axis, double angle) {
    return v * std::cos(angle) + glm::cross(axis, v) * std::sin(angle);
}

// The smallest cone that contains both.
void join_cones(Group& a, const Group& b) {
    glm::dvec3 other = b.axis;
    double cosine = glm::dot(a.axis, other);
    if (cosine < 0.0 && (a.two_sided || b.two_sided)) {
        if (b.two_sided) {
            other = -other;
        } else {
            a.axis = -a.axis;
        }
        cosine = -cosine;
    }
    const double between = std::acos(std::clamp(cosine, -1.0, 1.0));
    if (std::max(a.spread, b.spread) >= pi || a.spread >= std::min(between + b.spread, pi)) {
        a.spread = std::max(a.spread, b.spread);
        return;
    }
    if (b.spread >= std::min(between + a.spread, pi)) {
        a.axis = other;
        a.spread = b.spread;
        return;
    }
    const double spread = 0.5 * (a.spread + between + b.spread);
    const glm::dvec3 across = glm::cross(a.axis, other);
    const double length = glm::length(across);
    if (spread >= pi || !(length > 0.0)) {
        a.spread = pi;
        return;
    }
    a.axis = glm::normalize(rotated(a.axis, across / length, spread - a.spread));
    a.spread = spread;
}

Group joined(Group a, const Group& b) {
    join_cones(a, b);
    a.bounds.add(b.bounds.low, b.bounds.high);
    a.emission_angle = std::max(a.emission_angle, b.emission_angle);
    a.power += b.power;
    a.two_sided = a.two_sided || b.two_sided;
    a.is_area = a.is_area || b.is_area;
    return a;
}

// Leaves in one bin of the split axis.
struct Bin {
    LightBounds bounds;
    double power = 0.0;
    glm::dvec3 facing{0.0};  // sum of power times axis
    std::uint32_t count = 0;

    void add(const Bin& other) {
        bounds.add(other.bounds.low, other.bounds.high);
        power += other.power;
        facing += other.facing;
        count += other.count;
    }
    // Power x size^2 x a measure of the directions (Conty Estevez and Kulla 2018, eq. 2). The measure equals theirs at
    // both ends, 1 for one direction and 4 for all; in between it is linear in the length of the mean axis.
    double cost() const {
        if (!(power > 0.0)) return 0.0;
        return bounds.extent2() * (4.0 * power - 3.0 * glm::length(facing));
    }
};

class Builder {
  public:
    Builder(std::span<const LightLeaf> leaves, std::span<shading::Emitter> emitters)
        : leaves_(leaves), emitters_(emitters), order_(leaves.size()) {
        std::iota(order_.begin(), order_.end(), 0u);
        for (const LightLeaf& leaf : leaves) total_ += leaf.power;
        nodes_.reserve(2 * leaves.size());
    }

    std::vector<shading::LightNode> build() {
        nodes_.emplace_back();
        fill(0, 0, static_cast<std::uint32_t>(order_.size()), 0);
        return std::move(nodes_);
    }

  private:
    static constexpr std::uint32_t Bins = 16;

    // Fills node `at` with the leaves order_[begin, end).
    Group fill(std::uint32_t at, std::uint32_t begin, std::uint32_t end, std::uint32_t depth) {
        if (end - begin == 1) {
            const LightLeaf& leaf = leaves_[order_[begin]];
            emitters_[leaf.emitter].node = at;
            const Group group{{leaf.low, leaf.high}, leaf.axis,  leaf.spread,
                              leaf.emission_angle,   leaf.power, leaf.two_sided,
                              leaf.is_area};
            write(at, group, leaf.emitter | shading::LightLeaf);
            return group;
        }
        // Two binary splits give up to four children.
        std::array<std::uint32_t, shading::MaxLightChildren + 1> ends{begin};
        std::uint32_t count = 0;
        const std::uint32_t split = cut(begin, end, depth);
        const auto add = [&](std::uint32_t from, std::uint32_t to) {
            if (to - from > 1) ends[++count] = cut(from, to, depth + 1);
            ends[++count] = to;
        };
        add(begin, split);
        add(split, end);
        const auto first = static_cast<std::uint32_t>(nodes_.size());
        nodes_.resize(nodes_.size() + count);
        Group group;
        for (std::uint32_t i = 0; i < count; ++i) {
            const Group child = fill(first + i, ends[i], ends[i + 1], depth + 2);
            nodes_[first + i].parent = at;
            group = i == 0 ? child : joined(group, child);
        }
        const bool is_flat = count == end - begin && is_flat_lamp(begin, end, group);
        write(at, group,
              first | (count - 1) << shading::LightCountShift | (is_flat ? shading::LightByPower : 0u));
        return group;
    }

    // Whether the leaves are coplanar triangles of one light, like a rectangular lamp of two triangles.
    bool is_flat_lamp(std::uint32_t begin, std::uint32_t end, const Group& group) const {
        const LightLeaf& first = leaves_[order_[begin]];
        const double thickness = 1e-4 * std::sqrt(group.bounds.extent2());
        return std::all_of(order_.begin() + begin, order_.begin() + end, [&](std::uint32_t i) {
            const LightLeaf& leaf = leaves_[i];
            const double off = glm::dot(first.axis, centroid_of(i) - centroid_of(order_[begin]));
            return emitters_[leaf.emitter].light == emitters_[first.emitter].light && leaf.spread == 0.0 &&
                   !leaf.is_area && leaf.two_sided == first.two_sided &&
                   glm::dot(leaf.axis, first.axis) > 1.0 - 1e-6 && std::fabs(off) <= thickness;
        });
    }

    void write(std::uint32_t at, const Group& group, std::uint32_t link) {
        shading::LightNode& node = nodes_[at];
        const glm::dvec3 center = 0.5 * (group.bounds.low + group.bounds.high);
        node.center = glm::vec3(center);
        // Rounded up, so that the bounding sphere is conservative.
        const double radius =
            0.5 * std::sqrt(group.bounds.extent2()) + glm::length(center - glm::dvec3(node.center));
        node.radius = radius > 0.0 ? std::nextafter(static_cast<float>(radius), INFINITY) : 0.0f;
        node.axis = glm::vec3(group.axis);
        node.cos_spread = group.spread < pi ? static_cast<float>(std::cos(group.spread)) : -1.0f;
        node.cos_emission_angle = static_cast<float>(std::cos(group.emission_angle));
        // Clamped, so that a tiny fraction does not underflow to 0.
        node.power = std::max(static_cast<float>(group.power / total_), MinPower);
        node.link = link | (group.two_sided ? shading::LightTwoSided : 0u) |
                    (group.is_area ? shading::LightContainsArea : 0u);
    }

    glm::dvec3 centroid_of(std::uint32_t leaf) const {
        return 0.5 * (leaves_[leaf].low + leaves_[leaf].high);
    }

    // Partitions the leaves of a node and returns where the second child begins. Falls back to median splits where
    // splits by cost get too deep.
    std::uint32_t cut(std::uint32_t begin, std::uint32_t end, std::uint32_t depth) {
        LightBounds places;
        for (std::uint32_t i = begin; i < end; ++i)
            places.add(centroid_of(order_[i]), centroid_of(order_[i]));
        const glm::dvec3 size = places.high - places.low;
        const int axis = size.x >= size.y && size.x >= size.z ? 0 : (size.y >= size.z ? 1 : 2);
        const std::uint32_t half = begin + (end - begin) / 2;
        const double scale = Bins / size[axis];
        if (!std::isfinite(scale)) return half;  // all at the same position
        if (depth < MaxDepthByCost) {
            const auto bin_of = [&](std::uint32_t leaf) {
                const double place = (centroid_of(leaf)[axis] - places.low[axis]) * scale;
                return std::min(static_cast<std::uint32_t>(place), Bins - 1);
            };
            const std::uint32_t last = best_bin(begin, end, bin_of);
            const auto from = order_.begin() + begin;
            const auto split = std::stable_partition(
                from, order_.begin() + end, [&](std::uint32_t leaf) { return bin_of(leaf) <= last; });
            return begin + static_cast<std::uint32_t>(split - from);
        }
        const auto before = [&](std::uint32_t a, std::uint32_t b) {
            const double pa = centroid_of(a)[axis], pb = centroid_of(b)[axis];
            return pa != pb ? pa < pb : a < b;
        };
        std::nth_element(order_.begin() + begin, order_.begin() + half, order_.begin() + end, before);
        return half;
    }

    // The last bin of the first child. The first and the last bin are not empty.
    template <class BinOf>
    std::uint32_t best_bin(std::uint32_t begin, std::uint32_t end, const BinOf& bin_of) const {
        std::array<Bin, Bins> bins;
        for (std::uint32_t i = begin; i < end; ++i) {
            const LightLeaf& leaf = leaves_[order_[i]];
            const double facing = leaf.spread < pi && !leaf.two_sided ? leaf.power : 0.0;
            bins[bin_of(order_[i])].add({{leaf.low, leaf.high}, leaf.power, facing * leaf.axis, 1});
        }
        std::array<double, Bins> after{};  // cost of all bins from this one on
        Bin sum;
        for (std::uint32_t i = Bins; i-- > 1;) {
            sum.add(bins[i]);
            after[i] = sum.cost();
        }
        sum = Bin();
        double best_cost = Infinity;
        std::uint32_t best = 0;
        for (std::uint32_t i = 0; i + 1 < Bins; ++i) {
            sum.add(bins[i]);
            if (bins[i].count == 0) continue;  // the same split as the previous one
            const double cost = sum.cost() + after[i + 1];
            if (cost < best_cost) {
                best_cost = cost;
                best = i;
            }
        }
        return best;
    }

    // Splits by cost down to this depth, then at most 32 levels of median splits.
    static constexpr std::uint32_t MaxDepthByCost = 48;
    static constexpr float MinPower = 1e-24f;

    std::span<const LightLeaf> leaves_;
    std::span<shading::Emitter> emitters_;
    std::vector<std::uint32_t> order_;
    std::vector<shading::LightNode> nodes_;
    double total_ = 0.0;
};

}  // namespace

std::vector<shading::LightNode> make_light_tree(std::span<const LightLeaf> leaves,
                                                std::span<shading::Emitter> emitters) {
    if (leaves.empty()) return {};
    return Builder(leaves, emitters).build();
}

}  // namespace tessera::backend
