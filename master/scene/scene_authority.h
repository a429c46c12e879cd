#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "master/scene/authority_state.h"
#include "master/scene/edit_history.h"
#include "master/scene/edit_recorder.h"
#include "master/scene/editors.h"
#include "master/scene/object_locks.h"
#include "master/scene/version_log.h"
#include "mediator/scene/referrers.h"
#include "mediator/session/edits.h"

namespace tessera::master {

// Who sends an edit, and when: recorded with what it writes.
struct Editor {
    std::string name, user;
    std::int64_t time = 0;  // ns since 1970
};

// Owns the scene, numbers its versions and alone makes change lists. Edits are applied to the head at once,
// each for itself at the cost of its own objects, and are transactions that can be undone; publish() makes
// one version of all since the last. Pure: no sockets, no time.
class SceneAuthority {
  public:
    // `epoch` is new at every start of a master and never 0.
    SceneAuthority(std::uint64_t epoch, std::shared_ptr<scene::BlobStore> blobs);

    // From now on told of what happens, before anybody else; null: nobody. Must outlive its use.
    void record_to(EditRecorder* recorder) { recorder_ = recorder; }

    // ---- who edits ----
    using IdRange = master::IdRange;
    // The ids lent to the session for new objects. The same user with the same key, not 0, is the same editor
    // as before: it has its ids, its last sequence and its history, and the connection it had edits no more.
    // Key 0: an editor for this session only. No ids (count 0): none are left, or it cannot be recorded.
    IdRange join(SessionId session, const std::string& user, std::uint64_t key);
    IdRange lend_ids(SessionId session) { return join(session, "", 0); }  // the same again for the same one
    std::uint64_t last_sequence(SessionId session) const;                 // answered; 0 = none
    void forget(SessionId session);  // it is gone: its locks, too; with a key it may join again

    // ---- edits ----
    using Answer = EditAnswer;
    // All blobs must be in the store. Accepted whole or refused whole, with all the reasons. An edit resent
    // (same sequence as the last) gets its first answer again; an older one, or one after a gap, is refused.
    Answer submit(const scene::Edit& edit, const Editor& who = {});
    // Blobs the edit needs and the store lacks.
    std::vector<scene::BlobRef> missing_blobs(const scene::Edit& edit) const;

    // Moves the render origin to the camera's cell, if the camera has left the neighbourhood of the present
    // one, and publishes.
    std::optional<scene::ChangeList> follow_camera(const glm::dvec3& camera_position);
    // Back to the empty scene, published: what a batch leaves behind. Nobody edits any more, nothing can be
    // undone. Nothing when the scene was empty.
    std::optional<scene::ChangeList> clear();

    // ---- versions ----
    bool has_unpublished() const { return versions_.has_unpublished(); }
    // Everything since the last one; nothing when there is nothing. May have no entries: edits that took each
    // other back are a version, too, since their answers named it.
    std::optional<scene::ChangeList> publish();
    Version version() const { return versions_.version(); }        // published
    Version pending() const { return versions_.pending(); }        // that will hold what is not published yet
    Hash128 state_hash() const { return versions_.state_hash(); }  // at version()
    const scene::Scene& scene() const { return scene_; }           // the head
    // At version(), whatever was edited since.
    scene::ChangeList snapshot() const { return versions_.snapshot(scene_); }
    // From `known`, which was published, to version(); nothing when it is unknown or too old: use snapshot().
    std::optional<scene::ChangeList> since(Version known) const { return versions_.since(known, scene_); }

    // ---- locks, history ----
    std::vector<std::string> lock(SessionId session, const std::string& name,
                                  const std::vector<ObjectId>& objects);
    void unlock(SessionId session, const std::vector<ObjectId>& objects) { locks_.unlock(session, objects); }
    void release_all(SessionId session) { locks_.release_all(session); }
    std::vector<session::ObjectLock> locks() const { return locks_.all(); }
    std::vector<session::TransactionSummary> history(std::size_t count) const;  // youngest first
    std::vector<session::FieldWriter> writers(ObjectId object) const;           // of fields that were edited
    std::uint64_t transactions() const { return history_.last(); }              // so many there were

    // ---- checkpoints ----
    // All that a restarted master needs: a copy that shares its objects, so it costs little; the rest of the
    // work may be another thread's.
    AuthorityState save() const;
    // Before anything else happened, and without a recorder: the saved state, then what was recorded since,
    // one by one. An error: the record does not fit what is there; nothing after it will.
    void restore(AuthorityState state);
    Expected<void> replay(const wire::JournalRecord& record);
    // The end of it: the state is the first version of this epoch.
    void start_epoch();

  private:
    // What an edit asks for, understood: entries, and of an undo what it takes back.
    struct Request;
    std::optional<std::string> order_problem(const EditorRecord& editor, std::uint64_t sequence) const;
    Answer change(EditorRecord& editor, const scene::Edit& edit, const Editor& who);
    Answer undo(EditorRecord& editor, const scene::Edit& edit, const Editor& who);
    Answer carry_out(EditorRecord& editor, const scene::Edit& edit, const Request& request);
    std::vector<std::string> locks_problems(const EditorRecord& editor,
                                            const std::vector<scene::Entry>& entries) const;
    enum class Direction { Forth, Back };
    void index(const std::vector<scene::ObjectChange>& changes, Direction direction);
    void take_back(const std::vector<scene::ObjectChange>& changes);
    Transaction* open_transaction(const EditorRecord& editor, const scene::Edit& edit,
                                  const std::vector<scene::ObjectChange>& changes);
    Expected<void> replay_edit(const RecordedEdit& edit);
    void commit(EditorRecord& editor, const scene::Edit& edit, const Request& request,
                const std::vector<scene::ObjectChange>& changes, Transaction* open);

    std::shared_ptr<scene::BlobStore> blobs_;
    EditRecorder* recorder_ = nullptr;
    scene::Scene scene_;
    scene::ReferrerIndex referrers_;  // of scene_
    VersionLog versions_;
    Editors editors_;
    ObjectLocks locks_;
    EditHistory history_;
    WriterTable writers_;
};

// Cells of 256 m: within one, float32 resolves 2^-16 m (15 micrometres).
inline constexpr double RenderOriginCell = 256.0;

}  // namespace tessera::master
