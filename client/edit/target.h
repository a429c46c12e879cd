#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "mediator/base/clock.h"
#include "mediator/base/error.h"
#include "mediator/scene/blob.h"
#include "mediator/scene/scene.h"

namespace tessera::edit {

struct SubmitReply {
    bool accepted = false;
    std::uint64_t transaction = 0;      // its number, when accepted
    std::vector<std::string> problems;  // why not
};

struct HistoryLine {
    std::uint64_t number = 0;
    std::string name;       // of the member who did it
    std::int64_t time = 0;  // ns since 1970
    std::string text;       // what it did
    std::uint64_t undoes = 0, undone_by = 0;
};

struct FieldWriter {
    unsigned field = 0;
    std::uint64_t transaction = 0;
    std::string name;
};

struct Person {
    std::string name, user, text;  // text: what they say they do
    bool editor = false;
    std::vector<ObjectId> locked;
};

// What the language edits: a live scene on a master, or a local one. Calls block; they may throw Error in
// place of returning it. One thread.
class EditTarget {
  public:
    virtual ~EditTarget() = default;

    // Here, without asking anybody: the mirror; it holds what submit, undo and redo have answered. Stays as
    // it is until the next call of a function that is not const.
    virtual const scene::Scene& scene() const = 0;
    virtual Expected<ObjectId> new_id() = 0;         // free, and never given again
    virtual void add_blob(scene::BlobPtr blob) = 0;  // for entries to come
    virtual void refresh() = 0;                      // brings the mirror up to date; may ask

    virtual Expected<SubmitReply> submit(std::vector<scene::Entry> entries, const std::string& label) = 0;
    // Of the transaction with this number, or of this editor's latest one; what it was, for people.
    virtual Expected<std::string> undo(std::optional<std::uint64_t> transaction) = 0;
    virtual Expected<std::string> redo() = 0;
    virtual Expected<std::vector<HistoryLine>> history(std::uint32_t count) = 0;  // the youngest first
    virtual Expected<std::vector<FieldWriter>> writers(ObjectId object) = 0;
    virtual Expected<std::vector<Person>> people() = 0;
    virtual Expected<void> lock(const std::vector<ObjectId>& objects) = 0;
    virtual Expected<void> unlock(const std::vector<ObjectId>& objects) = 0;
    virtual Expected<scene::BlobPtr> blob(const scene::BlobRef& reference) = 0;
    virtual Expected<void> wait(Duration duration) = 0;
    virtual Expected<void> close() = 0;  // the scene, for everybody
};

}  // namespace tessera::edit
