#include "mediator/backend/flattening.h"

#include <algorithm>
#include <tuple>
#include <variant>

#include "mediator/scene/graph_size.h"
#include "mediator/scene/motion.h"

namespace tessera::backend {

namespace {

using scene::MotionHint;

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
    Flattener(const scene::Scene& scene, const scene::GraphSize& counted)
        : scene_(scene), counted_(counted) {}

    void children(const std::vector<ObjectId>& ids, const Inherited& above) {
        for (const ObjectId id : scene::distinct_children(ids)) {
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
    const scene::GraphSize& counted_;
    std::vector<ObjectId> path_;
    std::size_t moving_ = 0;  // number of transforms of the path that have motion keys
};

}  // namespace

Expected<FlatScene> flatten(const scene::Scene& scene, std::size_t limit) {
    const auto* root = scene.find_as<scene::Root>(scene::RootId);
    if (!root) return FlatScene{};

    // A graph with exponentially many paths is rejected before it is flattened.
    scene::GraphSize counter;
    if (const Expected<void> counted = counter.count(scene, limit); !counted)
        return tl::unexpected(counted.error());
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
