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
#include "mediator/scene/graph_size.h"
#include "mediator/scene/referrers.h"
#include "mediator/session/edits.h"

namespace tessera::master {

// Author and time of an edit, recorded with the fields it writes.
struct Editor {
    std::string name, user;
    std::int64_t time = 0;  // ns since 1970
};

// Owns the scene and its version numbers; the only source of change lists. Edits are applied to the head
// immediately, at a cost proportional to the objects they touch, and become transactions that can be undone;
// publish() makes one version of all edits since the last. Pure: no sockets, no clock.
class SceneAuthority {
  public:
    // `epoch` is new at every start of a master and never 0.
    SceneAuthority(std::uint64_t epoch, std::shared_ptr<scene::BlobStore> blobs);

    // Set the recorder that is called before an edit is acknowledged; null: none. It must outlive its use.
    void record_to(EditRecorder* recorder) { recorder_ = recorder; }

    // ---- editors ----
    using IdRange = master::IdRange;
    // Allocates the session's ids for new objects. The same user with the same non-zero key is the same editor: it
    // keeps its ids, last sequence and history, and its older connection can no longer edit. Key 0: an editor for
    // this session only. Count 0: no ids are left, or the editor cannot be recorded.
    IdRange join(SessionId session, const std::string& user, std::uint64_t key);
    IdRange allocate_id_range(SessionId session) { return join(session, "", 0); }  // idempotent per session
    std::uint64_t last_sequence(SessionId session) const;  // last answered edit; 0 = none
    void forget(SessionId session);                        // releases its locks; with a key it may join again

    // ---- edits ----
    using Answer = EditAnswer;
    // All blobs must be in the store. Accepted or refused as a whole, with all reasons. An edit sent again (same
    // sequence as the last) gets its first answer again; an older one, or one after a gap, is refused.
    Answer submit(const scene::Edit& edit, const Editor& who = {});
    // An edit was refused before it came here: the next one follows it.
    void refused(SessionId session, std::uint64_t sequence, std::string problem);
    // Objects that the edit may change.
    std::size_t size_of(const scene::Edit& edit) const;
    // Blobs that the edit needs and that are not in the store.
    std::vector<scene::BlobRef> missing_blobs(const scene::Edit& edit) const;

    // Undoes, youngest first, the transactions after `built` up to `published` that are in force: nodes cannot build
    // them. Each undo is recorded and listed like one by their author; `by` names who asked for it.
    struct Withdrawn {
        std::uint64_t transaction = 0;
        SessionId author;  // 0: not connected
        std::string text;  // what it was
    };
    std::vector<Withdrawn> withdraw(std::uint64_t built, std::uint64_t published, const Editor& by);

    // Whether the camera is in the neighbourhood of the render origin's cell.
    bool is_near_origin(const glm::dvec3& camera_position) const;
    // If it is not: moves the origin to the camera's cell, and publishes.
    std::optional<scene::ChangeList> follow_camera(const glm::dvec3& camera_position);
    // Resets to an empty, published scene without editors and history. Returns nothing if the scene was empty.
    std::optional<scene::ChangeList> clear();

    // ---- versions ----
    bool has_unpublished() const { return versions_.has_unpublished(); }
    std::size_t unpublished_objects() const { return versions_.unpublished_objects(); }
    // Publishes all edits since the last version; returns nothing if there are none. The list may be empty: edits
    // that cancel each other are a version too, since their answers named it.
    std::optional<scene::ChangeList> publish();
    const PublishedScene& published() const { return versions_.published(); }
    Version version() const { return published().version(); }
    // The version that the unpublished edits will have.
    Version pending() const { return versions_.pending(); }
    const scene::Scene& scene() const { return scene_; }  // the head

    // ---- locks, history ----
    std::vector<std::string> lock(SessionId session, const std::string& name,
                                  const std::vector<ObjectId>& objects);
    void unlock(SessionId session, const std::vector<ObjectId>& objects) { locks_.unlock(session, objects); }
    void release_all(SessionId session) { locks_.release_all(session); }
    std::vector<session::ObjectLock> locks() const { return locks_.all(); }
    std::vector<session::TransactionSummary> history(std::size_t count) const;  // youngest first
    std::vector<session::FieldWriter> writers(ObjectId object) const;           // of fields that were edited
    std::uint64_t transactions() const { return history_.last(); }              // total count

    // ---- checkpoints ----
    // The state that a restarted master needs: a cheap copy that shares its objects, to be written by another
    // thread.
    AuthorityState save() const;
    // Before any other call and without a recorder: restores the saved state, then each recorded change in order.
    // Error: the record does not match the state, and later ones will not either.
    void restore(AuthorityState state);
    Expected<void> replay(const wire::JournalRecord& record);
    // Ends the recovery: the state becomes the first version of this epoch.
    void start_epoch();

  private:
    // A resolved edit: its entries and, for an undo, what it reverts.
    struct Request;
    std::optional<std::string> order_problem(const EditorRecord& editor, std::uint64_t sequence) const;
    Answer change(EditorRecord& editor, const scene::Edit& edit, const Editor& who);
    Answer undo(EditorRecord& editor, const scene::Edit& edit, const Editor& who);
    Answer carry_out(EditorRecord& editor, const scene::Edit& edit, const Request& request);
    // Dangling references and so on, or a graph that back-ends cannot hold.
    std::vector<std::string> problems_after(const std::vector<scene::ObjectChange>& changes);
    std::vector<std::string> blob_problems(const std::vector<scene::Entry>& entries) const;
    std::vector<std::string> locks_problems(const EditorRecord& editor,
                                            const std::vector<scene::Entry>& entries) const;
    enum class Direction { Apply, Revert };
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
    scene::GraphSize graph_size_;     // of scene_
    VersionLog versions_;
    Editors editors_;
    ObjectLocks locks_;
    EditHistory history_;
    WriterTable writers_;
};

// Cells of 256 m: within one, float32 resolves 2^-16 m (15 micrometres).
inline constexpr double RenderOriginCell = 256.0;

}  // namespace tessera::master
