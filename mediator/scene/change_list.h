#pragma once

#include <cstdint>
#include <variant>
#include <vector>

#include "mediator/base/hash.h"
#include "mediator/base/ids.h"
#include "mediator/scene/objects.h"

namespace tessera::scene {

struct Create {
    ObjectId id;
    Object object;
};
// Only the fields in the mask mean anything (see Fields<T>); the object's alternative is the kind.
struct Update {
    ObjectId id;
    FieldMask mask = 0;
    Object fields;
};
struct Remove {
    ObjectId id;
};
using Entry = std::variant<Create, Update, Remove>;

ObjectId id(const Entry& entry);

// What leads from one version to the next; a value. A snapshot is a change list from nothing (`from.number` =
// 0). Each object has at most one entry; their order means nothing, since references are checked on the
// whole.
struct ChangeList {
    Version from, to;
    std::vector<Entry> entries;
    Hash128 state_hash;  // of the scene at `to`: the sum over objects of one hash each

    bool is_snapshot() const { return from.number == 0; }
};

// What a client wants changed. (session, sequence) makes a resent edit harmless.
struct Edit {
    SessionId session;
    std::uint64_t sequence = 0;
    Version base;
    std::vector<Entry> entries;
    // Edits in a row of one session with the same one, not 0, are one transaction: a drag.
    std::uint64_t gesture = 0;
    std::int64_t submitted_at = 0;  // ns, the client's clock; 0 = not told
    // Not 0: no entries, but the transaction whose writes are to be taken back; UndoLatest, RedoLatest: the
    // latest of this editor that can be.
    std::uint64_t undo = 0;
};
inline constexpr std::uint64_t UndoLatest = ~std::uint64_t{0};
inline constexpr std::uint64_t RedoLatest = ~std::uint64_t{0} - 1;

}  // namespace tessera::scene
