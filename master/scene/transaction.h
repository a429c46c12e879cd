#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "mediator/scene/inverse.h"

namespace tessera::master {

// Who wrote, and when: as it was said with the edit.
struct Writer {
    std::uint64_t transaction = 0;
    std::string name, user;
    std::int64_t time = 0;  // ns since 1970
};
using WriterPtr = std::shared_ptr<const Writer>;

// By number of the field. A null or absent writer: the field is as it came with the object.
using ObjectWriters = std::map<std::uint32_t, WriterPtr>;

struct TransactionChange {
    // Of an update only the fields of the mask mean anything: `before` as they were before this
    // transaction's first write, `after` as it left them.
    scene::ObjectChange object;
    ObjectWriters writers_before;  // of the fields of the mask; of all, where the object was removed
    ObjectWriters writers_after;   // of an undo or redo: whom it brought back
};

// By object. Copies share it until one of them is changed, so that a checkpoint's copy costs nothing.
class TransactionChanges {
  public:
    using Map = std::map<ObjectId, TransactionChange>;
    const Map& all() const { return *changes_; }
    Map& to_change();

  private:
    std::shared_ptr<Map> changes_ = std::make_shared<Map>();
};

enum class Nature : std::uint8_t { Edit, Undo, Redo };  // a redo takes back an undo

struct Transaction {
    std::uint64_t number = 0;
    std::uint64_t editor = 0;  // see Editors
    Nature nature = Nature::Edit;
    WriterPtr author;
    std::uint64_t gesture = 0;
    std::uint32_t edits = 1;
    std::uint64_t undoes = 0, undone_by = 0;  // numbers of others; 0 = none
    std::string text;                         // what it did, for people
    TransactionChanges changes;
};

// Who wrote each field last; only of fields that were edited.
class WriterTable {
  public:
    WriterPtr of(ObjectId id, std::uint32_t field) const;  // null: nobody
    const ObjectWriters& of(ObjectId id) const;
    void set(ObjectId id, std::uint32_t field, const WriterPtr& writer);
    void set(ObjectId id, const ObjectWriters& writers);
    ObjectWriters take(ObjectId id);
    void clear() { writers_.clear(); }
    // By object; copies of the table share what neither changes.
    using Map = std::map<ObjectId, std::shared_ptr<ObjectWriters>>;
    const Map& all() const { return writers_; }

  private:
    Map writers_;
};

// True when the changes can be told as part of the transaction, so that one undo takes both back. Not so
// where others came in between in a way that a field cannot hold: they rewrote the same list of children, or
// the object is another one now.
bool can_extend(const Transaction& transaction, const std::vector<scene::ObjectChange>& changes,
                const WriterTable& writers);

// Takes the changes, which are in the scene, into the transaction, and its author into the table.
void extend(Transaction& transaction, const std::vector<scene::ObjectChange>& changes, WriterTable& writers);

// The same for an undo, which brings writers back: also where the value was already what it is to be.
void record_undo(Transaction& undo, const std::vector<scene::ObjectChange>& changes,
                 const std::map<ObjectId, ObjectWriters>& brought_back, const scene::Scene& scene,
                 WriterTable& writers);

}  // namespace tessera::master
