#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

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
    Map& to_change();

  private:
    std::shared_ptr<Map> changes_ = std::make_shared<Map>();
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

// The last writer of each field that was edited.
class WriterTable {
  public:
    WriterPtr of(ObjectId id, std::uint32_t field) const;  // null: none
    const ObjectWriters& of(ObjectId id) const;
    void set(ObjectId id, std::uint32_t field, const WriterPtr& writer);
    void set(ObjectId id, const ObjectWriters& writers);
    ObjectWriters take(ObjectId id);
    void clear() { writers_.clear(); }
    // By object; copies of the table share unchanged entries.
    using Map = std::map<ObjectId, std::shared_ptr<ObjectWriters>>;
    const Map& all() const { return writers_; }

  private:
    Map writers_;
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
