#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "client/edit/path_book.h"
#include "client/edit/target.h"

namespace tessera::edit {

// What a rehearsed text amounts to, in order.
struct Transaction {
    std::vector<scene::Entry> entries;
    std::vector<scene::BlobPtr> blobs;
    std::string label;
    std::size_t line = 0;
};
struct Action {
    std::size_t line = 0;
    std::function<Expected<std::string>(EditTarget&)> run;  // what is to be printed, "" for nothing
};
using Step = std::variant<Transaction, Action>;

// Runs commands on a copy of the target's scene and collects what is to be done in earnest. Nothing is asked
// of the target but its mirror and new ids. What a command does beside editing is done after the edits that
// stand before it in its transaction (of a script: `Late`), or at once (at a prompt: `Soon`).
class Rehearsal {
  public:
    enum class Actions { Late, Soon };
    Rehearsal(EditTarget& target, Actions actions);

    // The line that the next calls belong to; `text` is what people will read about its edits.
    void enter(std::size_t line, std::string text);

    const scene::Scene& scene() const;  // throws ScriptError when it cannot be known, behind an undo
    const PathBook& book() const { return book_; }
    EditTarget& target() { return target_; }
    ObjectId read(const Word& path) const { return book_.read(scene(), path); }
    std::string path(ObjectId id) const { return book_.path(scene(), id); }

    // In full or not at all; throws ScriptError.
    void apply(const std::vector<scene::Entry>& entries);
    void add_blobs(const std::vector<scene::BlobPtr>& blobs);
    scene::BlobPtr pending_blob(const Hash256& hash) const;
    void print(std::string text);
    void act(std::function<Expected<std::string>(EditTarget&)> run);

    bool has_edits() const { return !touched_.empty(); }
    // Of the object, those that an action at this place would not yet find at the target; all bits when it is
    // new.
    scene::FieldMask uncommitted_fields(ObjectId id) const;
    void begin();     // throws ScriptError when a transaction is open that holds edits
    void commit();    // throws ScriptError, naming the line, when the scene would not be valid
    void rollback();  // to the last commit
    bool is_open() const { return is_open_; }  // by begin()

    // The scene behind an action that changes it in a way only the target knows.
    void lose_sight();
    void follow_target();  // takes its scene again; without edits

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
    PathBook book_;
    std::map<ObjectId, Touched> touched_;
    std::vector<scene::BlobPtr> blobs_;
    std::vector<std::string> texts_;  // of the lines with edits since the last commit
    std::string text_;
    std::size_t line_ = 0, first_line_ = 0;
    bool is_known_ = true, is_open_ = false, has_quit_ = false;
    std::vector<Step> steps_, late_;
};

}  // namespace tessera::edit
