#pragma once

#include <cstdint>
#include <map>
#include <string_view>
#include <utility>
#include <vector>

#include "mediator/scene/objects.h"

namespace tessera::scene {

// That one object names another.
struct Reference {
    ObjectId id;
    std::uint32_t kinds = 0;  // that it may have, a bit(kind) each
    std::string_view field;   // that names it: for messages
};
std::vector<Reference> references(const Object& object);
// The fields that hold them, as a mask.
FieldMask reference_fields(ObjectKind kind);

// The list of a root or a transform, else an empty one; its field as a mask, 0 where there is none.
const std::vector<ObjectId>& children(const Object& object);
FieldMask children_field(ObjectKind kind);

// References of `after` that `before` does not have, and the other way round; null is an object without any.
struct ReferenceChange {
    std::vector<Reference> added, removed;
};
ReferenceChange reference_change(const Object* before, const Object* after);

// Who refers to whom, so that an edit is checked at the cost of its own objects.
class ReferrerIndex {
  public:
    void replace(ObjectId id, const Object* before, const Object* after);
    std::vector<ObjectId> referrers(ObjectId target) const;  // each once, in id order

  private:
    std::map<std::pair<ObjectId, ObjectId>, std::uint64_t> counts_;  // (target, referrer): how often
};

}  // namespace tessera::scene
