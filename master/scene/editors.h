#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "mediator/base/ids.h"
#include "mediator/scene/scene.h"

namespace tessera::master {

struct IdRange {
    std::uint64_t first = 0, count = 0;  // count 0: none
    bool contains(ObjectId id) const { return id.value >= first && id.value - first < count; }
};

struct EditAnswer {
    bool accepted = false;
    Version version;                    // the version that contains the edit, or will when published
    std::vector<std::string> problems;  // why it was refused
    std::uint64_t transaction = 0;      // its transaction; 0: it changed nothing
    std::vector<std::string> notes;     // of an undo: fields that others changed since and that stay
};

// An editor, across connections: the same user with the same key is the same editor.
struct EditorRecord {
    std::uint64_t number = 0;  // never reused
    std::string user;
    std::uint64_t key = 0;  // 0: an editor of one connection
    IdRange ids;            // allocated for new objects
    std::uint64_t last_sequence = 0;
    EditAnswer last_answer;
    std::uint64_t edit_group = 0, edit_group_transaction = 0;  // that its next edit may extend
    SessionId session;                                         // 0: not connected
    bool may_skip = false;  // its next edit may have any later sequence number
};

// Pure.
class Editors {
  public:
    // How many disconnected editors are remembered.
    static constexpr std::size_t MaxDisconnected = 1024;

    // Null: all ids are allocated.
    EditorRecord* join(SessionId session, const std::string& user, std::uint64_t key,
                       const scene::Scene& scene);
    EditorRecord* of(SessionId session);
    const EditorRecord* of(SessionId session) const;
    void leave(SessionId session);
    void clear();  // ids are allocated from the first again

    const std::map<std::uint64_t, EditorRecord>& all() const { return editors_; }
    void restore(EditorRecord editor);
    void answer_at(Version version);  // sets the version that the last answers name
    EditorRecord* by_number(std::uint64_t number);

  private:
    std::optional<IdRange> free_ids(std::uint64_t count, const scene::Scene& scene);
    bool is_allocated(const IdRange& range) const;
    void forget_one_disconnected();

    std::map<std::uint64_t, EditorRecord> editors_;
    std::map<SessionId, std::uint64_t> sessions_;
    std::map<std::pair<std::string, std::uint64_t>, std::uint64_t> keys_;
    std::uint64_t last_number_ = 0;
    std::uint64_t next_id_ = FirstAllocatedId;

    static constexpr std::uint64_t FirstAllocatedId = 1u << 16;
};

}  // namespace tessera::master
