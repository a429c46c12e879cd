#pragma once

#include <cstdint>
#include <map>
#include <string_view>
#include <utility>
#include <vector>

#include "mediator/scene/objects.h"

namespace tessera::scene {

// A reference of one object to another.
struct Reference {
    ObjectId id;
    std::uint32_t kinds = 0;  // allowed kinds, a bit(kind) each
    std::string_view field;   // the field that holds it, for messages
};
std::vector<Reference> references(const Object& object);
// The fields that hold references, as a mask.
FieldMask reference_fields(ObjectKind kind);

// The children of a root or a transform, else an empty list; their field as a mask, else 0.
const std::vector<ObjectId>& children(const Object& object);
FieldMask children_field(ObjectKind kind);

// References added and removed between two states of an object; null has none.
struct ReferenceChange {
    std::vector<Reference> added, removed;
};
ReferenceChange reference_change(const Object* before, const Object* after);

// For each object, the objects that refer to it, so that checking an edit costs no more than its own objects.
class ReferrerIndex {
  public:
    void replace(ObjectId id, const Object* before, const Object* after);
    std::vector<ObjectId> referrers(ObjectId target) const;  // each once, in id order

  private:
    std::map<std::pair<ObjectId, ObjectId>, std::uint64_t> counts_;  // (target, referrer): how often
};

}  // namespace tessera::scene
