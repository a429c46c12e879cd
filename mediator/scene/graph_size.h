#pragma once

#include <cstdint>
#include <string>
#include <unordered_map>
#include <vector>

#include "mediator/base/error.h"
#include "mediator/scene/inverse.h"
#include "mediator/scene/referrers.h"
#include "mediator/scene/scene.h"

namespace tessera::scene {

// What back-ends can hold. The authority refuses edits beyond these limits, and back-ends refuse to flatten such scenes,
// both by GraphSize.
inline constexpr std::size_t MaxDepth = 1024;             // nested transforms
inline constexpr std::size_t MaxPlacements = 16'000'000;  // instances and lights after flattening

// The size of a scene graph after flattening, without flattening it: shared subtrees are counted once and multiplied.
// Keeps the totals of every transform, so that a second count after an edit visits only what changed and what is above.
class GraphSize {
  public:
    // Counts what has changed since the last call that succeeded, or everything. InvalidInput: a cycle below the root, a graph deeper than
    // MaxDepth, or more than `limit` instances and lights. A missing child is skipped (validation reports it); a child
    // that a parent lists twice counts once.
    Expected<void> count(const Scene& scene, std::size_t limit = MaxPlacements);
    // Forgets the totals that these changes, applied or taken back, may alter: those of the transforms themselves and of
    // all above them. `referrers`: of the scene after the changes.
    void changed(const std::vector<ObjectChange>& changes, const ReferrerIndex& referrers);

    // After count(): whether there are instances or lights below a transform that is reachable from the root.
    bool has_placements(ObjectId transform) const { return known_.at(transform).placements > 0; }

  private:
    struct Totals {
        double placements = 0;  // < 0: being visited
        double path_ids = 0;    // elements of all paths, from this transform down
        std::size_t depth = 0;
    };
    Expected<Totals> below(const Scene& scene, const std::vector<ObjectId>& children, std::size_t level);
    Expected<Totals> transform(const Scene& scene, ObjectId id, const Transform& transform,
                               std::size_t level);
    void forget(ObjectId id, const ReferrerIndex& referrers);

    std::unordered_map<ObjectId, Totals> known_;
    bool stale_ = true;  // the last count does not hold any more
};

// The children of an object without duplicates, in id order.
std::vector<ObjectId> distinct_children(const std::vector<ObjectId>& children);

}  // namespace tessera::scene
