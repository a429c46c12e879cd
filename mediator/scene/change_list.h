#pragma once

#include <cstdint>
#include <tuple>
#include <variant>
#include <vector>

#include "mediator/base/description.h"
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
inline constexpr std::size_t MaxEntries = 16'000'000;  // that are decoded

ObjectId id(const Entry& entry);

// What leads from one version to the next; a value. A snapshot is a change list from nothing (`from.number` =
// 0). Each object has at most one entry; their order means nothing, since references are checked on the
// whole.
struct ChangeList {
    Version from, to;
    std::vector<Entry> entries;
    Hash128 state_hash;  // of the scene at `to`: the sum over objects of one hash each

    bool is_snapshot() const { return from.number == 0; }
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "from", &ChangeList::from), row(2, "to", &ChangeList::to),
                          row(3, "entries", &ChangeList::entries, Limit{MaxEntries}),
                          row(4, "state_hash", &ChangeList::state_hash));
    }
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
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "session", &Edit::session), row(2, "sequence", &Edit::sequence),
                          row(3, "base", &Edit::base), row(4, "entries", &Edit::entries, Limit{MaxEntries}),
                          row(5, "gesture", &Edit::gesture), row(6, "submitted_at", &Edit::submitted_at),
                          row(7, "undo", &Edit::undo));
    }
};
inline constexpr std::uint64_t UndoLatest = ~std::uint64_t{0};
inline constexpr std::uint64_t RedoLatest = ~std::uint64_t{0} - 1;

}  // namespace tessera::scene
