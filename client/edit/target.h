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
    std::vector<std::string> problems;  // reasons for the rejection
};

struct HistoryLine {
    std::uint64_t number = 0;
    std::string name;       // of the member that made it
    std::int64_t time = 0;  // ns since 1970
    std::string text;       // description
    std::uint64_t undoes = 0, undone_by = 0;
};

struct FieldWriter {
    unsigned field = 0;
    std::uint64_t transaction = 0;
    std::string name;
};

struct Member {
    std::string name, user, text;  // text: status set by the client
    bool editor = false;
    std::vector<ObjectId> locked;
};

// The scene that edit commands work on: a live scene on a master, or a local one. Calls block, and may throw Error
// instead of returning it. Not thread-safe.
class EditTarget {
  public:
    virtual ~EditTarget() = default;

    // The local mirror; no request to the master. Includes the results of submit, undo and redo. Unchanged until the
    // next call of a non-const function.
    virtual const scene::Scene& scene() const = 0;
    virtual Expected<ObjectId> new_id() = 0;         // unused, and never returned again
    virtual void add_blob(scene::BlobPtr blob) = 0;  // for entries submitted later
    virtual void refresh() = 0;                      // updates the mirror; may send a request to the master

    virtual Expected<SubmitReply> submit(std::vector<scene::Entry> entries, const std::string& label) = 0;
    // Undoes the transaction with this number, or this editor's latest one. Returns a description of it.
    virtual Expected<std::string> undo(std::optional<std::uint64_t> transaction) = 0;
    virtual Expected<std::string> redo() = 0;
    virtual Expected<std::vector<HistoryLine>> history(std::uint32_t count) = 0;  // newest first
    virtual Expected<std::vector<FieldWriter>> writers(ObjectId object) = 0;
    virtual Expected<std::vector<Member>> members() = 0;
    virtual Expected<void> lock(const std::vector<ObjectId>& objects) = 0;
    virtual Expected<void> unlock(const std::vector<ObjectId>& objects) = 0;
    virtual Expected<scene::BlobPtr> blob(const scene::BlobRef& reference) = 0;
    virtual Expected<void> wait(Duration duration) = 0;
    virtual Expected<void> close() = 0;  // closes the scene for all clients
};

}  // namespace tessera::edit
