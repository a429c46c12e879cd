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
// Only the fields in the mask are set (see Fields<T>); the variant's alternative is the kind.
struct Update {
    ObjectId id;
    FieldMask mask = 0;
    Object fields;
};
struct Remove {
    ObjectId id;
};
using Entry = std::variant<Create, Update, Remove>;
inline constexpr std::size_t MaxEntries = 16'000'000;     // of a change list; decoder limit
inline constexpr std::size_t MaxEditEntries = 2'000'000;  // of one edit

ObjectId id(const Entry& entry);

// The difference from one version to the next. A snapshot is a change list from nothing (`from.number` = 0). Each
// object has at most one entry; their order is irrelevant, since references are checked at the end.
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

// An edit request of a client. (session, sequence) identifies it, so that a resent edit is applied once.
struct Edit {
    SessionId session;
    std::uint64_t sequence = 0;
    Version base;
    std::vector<Entry> entries;
    // Consecutive edits of a session with the same group, not 0, are one transaction (one undo step): a drag.
    std::uint64_t edit_group = 0;
    std::int64_t submitted_at = 0;  // ns, the client's clock; 0 = unknown
    // Not 0: there are no entries; this transaction is undone. UndoLatest, RedoLatest: the latest possible one of this
    // editor.
    std::uint64_t undo = 0;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "session", &Edit::session), row(2, "sequence", &Edit::sequence),
                          row(3, "base", &Edit::base),
                          row(4, "entries", &Edit::entries, Limit{MaxEditEntries}),
                          row(5, "edit_group", &Edit::edit_group),
                          row(6, "submitted_at", &Edit::submitted_at), row(7, "undo", &Edit::undo));
    }
};
inline constexpr std::uint64_t UndoLatest = ~std::uint64_t{0};
inline constexpr std::uint64_t RedoLatest = ~std::uint64_t{0} - 1;

}  // namespace tessera::scene
