#include "mediator/backend/flattening.h"

#include <algorithm>
#include <tuple>
#include <unordered_map>
#include <variant>

#include "mediator/scene/motion.h"

namespace tessera::backend {

namespace {

using scene::MotionHint;

constexpr std::size_t IdsPerPlacement = 64;  // mean path length from which a graph is rejected as malformed

std::vector<ObjectId> distinct(std::vector<ObjectId> children) {
    std::sort(children.begin(), children.end());
    children.erase(std::unique(children.begin(), children.end()), children.end());
    return children;
}

// Totals of a transform's subtree, computed once per transform. A graph with exponentially many paths is rejected
// before it is flattened, and subtrees without geometries and lights are not visited.
struct SubtreeStats {
    double placements = 0;
    double path_ids = 0;  // elements of all paths, from this transform down
    std::size_t depth = 0;
};

class GraphCounter {
  public:
    explicit GraphCounter(const scene::Scene& scene) : scene_(scene) {}

    Expected<SubtreeStats> children(const std::vector<ObjectId>& ids, std::size_t level) {
        if (level > MaxDepth) return too_deep();
        SubtreeStats sum;
        for (const ObjectId id : distinct(ids)) {
            const scene::Object* object = scene_.find(id);
            if (!object) continue;
            if (std::holds_alternative<scene::Geometry>(*object) ||
                std::holds_alternative<scene::Light>(*object)) {
                sum.placements += 1;
            } else if (std::holds_alternative<scene::Transform>(*object)) {
                Expected<SubtreeStats> child = transform(id, std::get<scene::Transform>(*object), level + 1);
                if (!child) return child;
                sum.placements += child->placements;
                sum.path_ids += child->path_ids + child->placements;
                sum.depth = std::max(sum.depth, child->depth + 1);
            }
        }
        if (level + sum.depth > MaxDepth)
            return too_deep();  // a shared subtree that was first visited at a smaller depth
        return sum;
    }

    bool has_placements(ObjectId transform) const { return known_.at(transform).placements > 0; }

  private:
    static tl::unexpected<Error> too_deep() {
        return failure(ErrorCode::InvalidInput, "the scene graph is nested deeper than " +
                                                    std::to_string(MaxDepth) + " transforms; flatten it");
    }

    Expected<SubtreeStats> transform(ObjectId id, const scene::Transform& transform, std::size_t level) {
        const auto [place, fresh] = known_.try_emplace(id, SubtreeStats{-1});
        if (!fresh) {
            if (place->second.placements >= 0) return place->second;
            return failure(ErrorCode::InvalidInput, "transform " + std::to_string(id.value) + " '" +
                                                        transform.name +
                                                        "' contains itself; remove one link of the cycle");
        }
        Expected<SubtreeStats> below = children(transform.children, level);
        if (below) known_[id] = *below;
        return below;
    }

    const scene::Scene& scene_;
    std::unordered_map<ObjectId, SubtreeStats> known_;  // placements < 0: being visited
};

// State inherited from the transforms above.
struct Inherited {
    glm::dmat4 world{1.0};
    MotionHint hint = MotionHint::Unflagged;
    std::uint32_t layers = scene::RootLayers;

    Inherited below(const scene::Transform& transform) const {
        return {.world = world * transform.matrix,
                .hint = transform.hint == MotionHint::Unflagged ? hint : transform.hint,
                .layers = transform.layers == 0 ? layers : transform.layers};
    }
};

class Flattener {
  public:
    Flattener(const scene::Scene& scene, const GraphCounter& counted) : scene_(scene), counted_(counted) {}

    void children(const std::vector<ObjectId>& ids, const Inherited& above) {
        for (const ObjectId id : distinct(ids)) {
            const scene::Object* object = scene_.find(id);
            if (!object) continue;
            if (const auto* geometry = std::get_if<scene::Geometry>(object)) {
                const MotionHint own = geometry->hint == MotionHint::Unflagged ? above.hint : geometry->hint;
                result.instances.push_back({id, above.world, own, above.layers, path_, motion()});
            } else if (std::holds_alternative<scene::Light>(*object)) {
                result.lights.push_back({id, above.world, above.layers, path_, motion()});
            } else if (const auto* transform = std::get_if<scene::Transform>(object)) {
                if (!counted_.has_placements(id)) continue;
                path_.push_back(id);
                moving_ += transform->motion.empty() ? 0 : 1;
                children(transform->children, above.below(*transform));
                moving_ -= transform->motion.empty() ? 0 : 1;
                path_.pop_back();
            }
        }
    }

    FlatScene result;

  private:
    std::vector<glm::dmat4> motion() const {
        return moving_ == 0 ? std::vector<glm::dmat4>() : scene::motion_along(scene_, path_);
    }

    const scene::Scene& scene_;
    const GraphCounter& counted_;
    std::vector<ObjectId> path_;
    std::size_t moving_ = 0;  // number of transforms of the path that have motion keys
};

}  // namespace

Expected<FlatScene> flatten(const scene::Scene& scene, std::size_t limit) {
    const auto* root = scene.find_as<scene::Root>(scene::RootId);
    if (!root) return FlatScene{};

    GraphCounter counter(scene);
    const Expected<SubtreeStats> all = counter.children(root->children, 0);
    if (!all) return tl::unexpected(all.error());
    const double max_placements = static_cast<double>(limit);
    if (all->placements > max_placements || all->path_ids > max_placements * IdsPerPlacement) {
        return failure(ErrorCode::InvalidInput,
                       "the scene has more than " + std::to_string(limit) +
                           " instances after flattening; use fewer instances, or split the scene");
    }
    Flattener flattener(scene, counter);
    flattener.children(root->children, {});
    FlatScene flat_scene = std::move(flattener.result);
    std::sort(flat_scene.instances.begin(), flat_scene.instances.end(),
              [](const Instance& a, const Instance& b) {
                  return std::tie(a.geometry, a.path) < std::tie(b.geometry, b.path);
              });
    std::sort(flat_scene.lights.begin(), flat_scene.lights.end(),
              [](const PlacedLight& a, const PlacedLight& b) {
                  return std::tie(a.light, a.path) < std::tie(b.light, b.path);
              });
    return flat_scene;
}

glm::dmat4 placement(const scene::Scene& scene, std::span<const ObjectId> path) {
    glm::dmat4 world(1.0);
    for (const ObjectId id : path) {
        if (const auto* transform = scene.find_as<scene::Transform>(id)) world = world * transform->matrix;
    }
    return world;
}

}  // namespace tessera::backend
