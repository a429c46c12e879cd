#include "mediator/scene/graph_size.h"

#include <algorithm>
#include <variant>

#include "mediator/scene/fields.h"

namespace tessera::scene {

namespace {

constexpr double IdsPerPlacement = 64;  // mean path length from which a graph is rejected as malformed

tl::unexpected<Error> too_deep() {
    return failure(ErrorCode::InvalidInput, "the scene graph is nested deeper than " +
                                                std::to_string(MaxDepth) + " transforms; flatten it");
}

}  // namespace

std::vector<ObjectId> distinct_children(const std::vector<ObjectId>& children) {
    std::vector<ObjectId> ids = children;
    std::sort(ids.begin(), ids.end());
    ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
    return ids;
}

Expected<void> GraphSize::count(const Scene& scene, std::size_t limit) {
    if (!stale_) return {};
    const auto* root = scene.find_as<Root>(RootId);
    if (!root) return {};
    const Expected<Totals> all = below(scene, root->children, 0);
    if (!all) return tl::unexpected(all.error());
    const double most = static_cast<double>(limit);
    if (all->placements > most || all->path_ids > most * IdsPerPlacement) {
        return failure(ErrorCode::InvalidInput,
                       "the scene has more than " + std::to_string(limit) +
                           " instances after flattening; use fewer instances, or split the scene");
    }
    stale_ = false;
    return {};
}

Expected<GraphSize::Totals> GraphSize::below(const Scene& scene, const std::vector<ObjectId>& children,
                                             std::size_t level) {
    if (level > MaxDepth) return too_deep();
    Totals sum;
    for (const ObjectId id : distinct_children(children)) {
        const Object* object = scene.find(id);
        if (!object) continue;
        if (std::holds_alternative<Geometry>(*object) || std::holds_alternative<Light>(*object)) {
            sum.placements += 1;
        } else if (const auto* child = std::get_if<Transform>(object)) {
            Expected<Totals> totals = transform(scene, id, *child, level + 1);
            if (!totals) return totals;
            sum.placements += totals->placements;
            sum.path_ids += totals->path_ids + totals->placements;
            sum.depth = std::max(sum.depth, totals->depth + 1);
        }
    }
    // A shared or remembered subtree may be deeper than what was visited here.
    if (level + sum.depth > MaxDepth) return too_deep();
    return sum;
}

Expected<GraphSize::Totals> GraphSize::transform(const Scene& scene, ObjectId id, const Transform& transform,
                                                 std::size_t level) {
    const auto [known, fresh] = known_.try_emplace(id, Totals{.placements = -1});
    if (!fresh) {
        if (known->second.placements >= 0) return known->second;
        return failure(ErrorCode::InvalidInput, "transform " + std::to_string(id.value) + " '" +
                                                    transform.name +
                                                    "' contains itself; remove one link of the cycle");
    }
    Expected<Totals> totals = below(scene, transform.children, level);
    if (totals) {
        known_[id] = *totals;
    } else {
        known_.erase(id);
    }
    return totals;
}

void GraphSize::forget(ObjectId id, const ReferrerIndex& referrers) {
    std::vector<ObjectId> open{id};
    while (!open.empty()) {
        const ObjectId next = open.back();
        open.pop_back();
        for (const ObjectId above : referrers.referrers(next)) {
            if (known_.erase(above) != 0) open.push_back(above);
        }
    }
}

void GraphSize::changed(const std::vector<ObjectChange>& changes, const ReferrerIndex& referrers) {
    for (const ObjectChange& change : changes) {
        if (change.is_update() && (change.mask & children_field(kind(*change.after))) == 0) continue;
        stale_ = true;
        known_.erase(change.id);
        forget(change.id, referrers);
    }
}

}  // namespace tessera::scene
