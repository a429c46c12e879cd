#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "client/edit/path_index.h"
#include "client/edit/target.h"

namespace tessera::edit {

// The steps that a dry run recorded, in order.
struct Transaction {
    std::vector<scene::Entry> entries;
    std::vector<scene::BlobPtr> blobs;
    std::string label;
    std::size_t line = 0;
};
struct Action {
    std::size_t line = 0;
    std::function<Expected<std::string>(EditTarget&)> run;  // returns text to print, may be empty
};
using Step = std::variant<Transaction, Action>;

// Runs commands on a copy of the target's scene and records the steps to execute. Of the target, only the mirror and
// new ids are used. Actions other than edits are executed after the preceding edits of their transaction (in a script:
// `AtCommit`) or immediately (at a prompt: `Immediately`).
class DryRun {
  public:
    enum class Actions { AtCommit, Immediately };
    DryRun(EditTarget& target, Actions actions);

    // The line that the next calls belong to; `text` describes its edits in the history.
    void start_line(std::size_t line, std::string text);

    const scene::Scene& scene() const;  // throws ScriptError if it is unknown, after an undo
    const PathIndex& path_index() const { return path_index_; }
    EditTarget& target() { return target_; }
    ObjectId read(const Word& path) const { return path_index_.read(scene(), path); }
    std::string path(ObjectId id) const { return path_index_.path(scene(), id); }

    // Atomic; throws ScriptError.
    void apply(const std::vector<scene::Entry>& entries);
    void add_blobs(const std::vector<scene::BlobPtr>& blobs);
    scene::BlobPtr pending_blob(const Hash256& hash) const;
    void print(std::string text);
    void add_action(std::function<Expected<std::string>(EditTarget&)> run);

    bool has_edits() const { return !touched_.empty(); }
    // The object's fields with edits that the target does not have yet; all bits if the object is new.
    scene::FieldMask uncommitted_fields(ObjectId id) const;
    void begin();     // throws ScriptError if a transaction with edits is open
    void commit();    // throws ScriptError with the line if the scene would be invalid
    void rollback();  // to the last commit
    bool is_open() const { return is_open_; }  // by begin()

    // To be called before an action with an effect on the scene that only the target knows.
    void mark_scene_unknown();
    void sync_with_target();  // copies the target's scene again, unless there are edits

    void quit() { has_quit_ = true; }
    bool has_quit() const { return has_quit_; }
    std::vector<Step> take_steps();

  private:
    struct Touched {
        std::shared_ptr<const scene::Object> before;  // null: was not there
        std::size_t line = 0;
    };
    std::vector<scene::Entry> entries() const;

    EditTarget& target_;
    Actions actions_;
    scene::Scene scene_;
    PathIndex path_index_;
    std::map<ObjectId, Touched> touched_;
    std::vector<scene::BlobPtr> blobs_;
    std::vector<std::string> texts_;  // of the lines with edits since the last commit
    std::string text_;
    std::size_t line_ = 0, first_line_ = 0;
    bool is_known_ = true, is_open_ = false, has_quit_ = false;
    std::vector<Step> steps_, deferred_;
};

}  // namespace tessera::edit
