#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "mediator/base/copy_on_write.h"
#include "mediator/scene/inverse.h"

namespace tessera::master {

// Author and time, as sent with the edit.
struct Writer {
    std::uint64_t transaction = 0;
    std::string name, user;
    std::int64_t time = 0;  // ns since 1970
};
using WriterPtr = std::shared_ptr<const Writer>;

// By field number. A null or absent writer: the field has not been written since the object was created.
using ObjectWriters = std::map<std::uint32_t, WriterPtr>;

struct TransactionChange {
    // Of an update only the fields of the mask mean anything: `before` as they were before this
    // transaction's first write, `after` as it left them.
    scene::ObjectChange object;
    ObjectWriters writers_before;  // of the fields of the mask; of all, where the object was removed
    ObjectWriters writers_after;   // of an undo or redo: the restored writers
};

// By object. Copy-on-write, so that a checkpoint's copy is free.
class TransactionChanges {
  public:
    using Map = std::map<ObjectId, TransactionChange>;
    const Map& all() const { return *changes_; }
    Map& to_change() { return changes_.edit(); }

  private:
    CopyOnWrite<Map> changes_;
};

enum class Nature : std::uint8_t { Edit, Undo, Redo };  // a redo undoes an undo

struct Transaction {
    std::uint64_t number = 0;
    std::uint64_t editor = 0;  // see Editors
    Nature nature = Nature::Edit;
    WriterPtr author;
    std::uint64_t edit_group = 0;
    std::uint32_t edits = 1;
    std::uint64_t undoes = 0, undone_by = 0;  // numbers of others; 0 = none
    std::string text;                         // readable summary
    TransactionChanges changes;
};

// The last writer of each field that was edited. Copies are cheap: they share, copy on write, all groups of objects.
class WriterTable {
  public:
    WriterPtr of(ObjectId id, std::uint32_t field) const;  // null: none
    const ObjectWriters& of(ObjectId id) const;
    void set(ObjectId id, std::uint32_t field, const WriterPtr& writer);
    void set(ObjectId id, const ObjectWriters& writers);
    ObjectWriters take(ObjectId id);
    void clear() { groups_.clear(); }
    // Calls visit(ObjectId, const ObjectWriters&) in the order of the ids.
    template <class Visit>
    void for_each(const Visit& visit) const {
        for (const auto& [number, group] : groups_) {
            for (const auto& [id, writers] : *group) visit(id, writers);
        }
    }

  private:
    using Group = std::map<ObjectId, ObjectWriters>;  // objects of neighbouring ids
    static std::uint64_t group_of(ObjectId id) { return id.value / 128; }

    std::map<std::uint64_t, CopyOnWrite<Group>> groups_;
};

// True if the changes can be merged into the transaction, so that one undo reverts both. False if others have
// rewritten the same list of children since, or the object was replaced by another.
bool can_extend(const Transaction& transaction, const std::vector<scene::ObjectChange>& changes,
                const WriterTable& writers);

// Adds the changes, which are already applied, to the transaction, and its author to the table.
void extend(Transaction& transaction, const std::vector<scene::ObjectChange>& changes, WriterTable& writers);

// The same for an undo, which restores writers, also of fields whose value does not change.
void record_undo(Transaction& undo, const std::vector<scene::ObjectChange>& changes,
                 const std::map<ObjectId, ObjectWriters>& brought_back, const scene::Scene& scene,
                 WriterTable& writers);

}  // namespace tessera::master
