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
    std::uint64_t first = 0, count = 0;  // count 0: there is none
    bool contains(ObjectId id) const { return id.value >= first && id.value - first < count; }
};

struct EditAnswer {
    bool accepted = false;
    Version version;                    // that holds the edit, or will when it is published
    std::vector<std::string> problems;  // why not
    std::uint64_t transaction = 0;      // that it is, or is part of; 0: it changed nothing
    std::vector<std::string> notes;     // of an undo: what stays as others made it
};

// Who edits, over several connections: the same user with the same key is the same editor.
struct EditorRecord {
    std::uint64_t number = 0;  // never given again
    std::string user;
    std::uint64_t key = 0;  // 0: an editor of one connection
    IdRange ids;            // lent for new objects
    std::uint64_t last_sequence = 0;
    EditAnswer last_answer;
    std::uint64_t gesture = 0, gesture_transaction = 0;  // that its next edit may go on with
    SessionId session;                                   // 0: not connected
    bool may_skip = false;  // its next edit may have any younger sequence: it says where it goes on
};

// Pure.
class Editors {
  public:
    // So many editors that are not connected are remembered.
    static constexpr std::size_t MaxAway = 1024;

    // Null: all ids are lent.
    EditorRecord* join(SessionId session, const std::string& user, std::uint64_t key,
                       const scene::Scene& scene);
    EditorRecord* of(SessionId session);
    const EditorRecord* of(SessionId session) const;
    void leave(SessionId session);
    void clear();  // ids are lent from the first again

    const std::map<std::uint64_t, EditorRecord>& all() const { return editors_; }
    void restore(EditorRecord editor);
    void answer_at(Version version);  // the last answers name a version that is known
    EditorRecord* by_number(std::uint64_t number);

  private:
    std::optional<IdRange> free_ids(std::uint64_t count, const scene::Scene& scene);
    bool lent(const IdRange& range) const;
    void forget_one_away();

    std::map<std::uint64_t, EditorRecord> editors_;
    std::map<SessionId, std::uint64_t> sessions_;
    std::map<std::pair<std::string, std::uint64_t>, std::uint64_t> keys_;
    std::uint64_t last_number_ = 0;
    std::uint64_t next_id_ = FirstLentId;

    static constexpr std::uint64_t FirstLentId = 1u << 16;
};

}  // namespace tessera::master
