#include "master/scene/session_log.h"

#include <algorithm>
#include <map>
#include <set>

#include "master/scene/checkpoint_file.h"
#include "master/scene/session_folder.h"
#include "master/scene/transaction_text.h"
#include "mediator/wire/journal_codec.h"

namespace tessera::master {

namespace {

class Reader {
  public:
    explicit Reader(const std::string& wanted) : wanted_(wanted) {}

    SessionLog read(const std::filesystem::path& folder) {
        const SessionFiles files = session_files(folder);
        // A journal that is complete from its start needs no checkpoint.
        const bool is_whole = !files.journals.empty() && files.journals.front() == 1;
        if (!files.checkpoints.empty() && !is_whole) {
            const std::uint64_t number = files.checkpoints.front();
            if (const auto state = read_checkpoint(checkpoint_path(folder, number), number)) {
                take(*state);
            } else {
                log_.notes.push_back("checkpoint " + std::string(state.error().what()));
            }
        }
        for (const std::uint64_t number : files.journals) {
            const JournalScan scan =
                read_journal(journal_path(folder, number), number, [&](std::span<const std::byte> bytes) {
                    const auto record = wire::decode_journal_record(bytes);
                    if (!record) return Expected<void>(tl::unexpected(record.error()));
                    if (const auto* edit = std::get_if<wire::RecordedEdit>(&*record)) take(*edit);
                    return Expected<void>();
                });
            const bool being_written = scan.end == JournalEnd::Torn && number == files.journals.back();
            if (scan.end != JournalEnd::Complete && !being_written)
                log_.notes.push_back("journal " + scan.text);
        }
        for (auto& [number, transaction] : transactions_) {
            auto& objects = transaction.objects;
            std::sort(objects.begin(), objects.end());
            objects.erase(std::unique(objects.begin(), objects.end()), objects.end());
            const bool touches = std::any_of(objects.begin(), objects.end(),
                                             [&](ObjectId id) { return matching_.contains(id); });
            if (wanted_.empty() || touches) log_.transactions.push_back(std::move(transaction));
        }
        return std::move(log_);
    }

  private:
    void see(ObjectId id, const scene::Object* object) {
        if (wanted_ == std::to_string(id.value)) matching_.insert(id);
        if (object && wanted_ == object_path(id, *object)) matching_.insert(id);
    }

    void take(const wire::CheckpointState& state) {
        for (const scene::Entry& entry : state.scene.entries)
            see(scene::id(entry), &std::get<scene::Create>(entry).object);
        for (const wire::RecordedTransaction& from : state.transactions) {
            const wire::RecordedWriter& author = state.writers[from.author - 1];
            LoggedTransaction& to = transactions_[from.number];
            to = {.number = from.number,
                  .name = author.name,
                  .user = author.user,
                  .time = author.time,
                  .edits = from.edits,
                  .undoes = from.undoes,
                  .text = from.text,
                  .objects = {}};
            for (const wire::RecordedChange& change : from.changes) {
                to.objects.push_back(change.object);
                for (const auto& object : {change.before, change.after})
                    see(change.object, object ? &*object : nullptr);
            }
        }
    }

    void take(const wire::RecordedEdit& edit) {
        for (const scene::Entry& entry : edit.entries) {
            const auto* created = std::get_if<scene::Create>(&entry);
            const auto* updated = std::get_if<scene::Update>(&entry);
            see(scene::id(entry), created ? &created->object : updated ? &updated->fields : nullptr);
        }
        if (edit.transaction == 0) return;  // an edit of the master itself
        LoggedTransaction& to = transactions_[edit.transaction];
        to.number = edit.transaction;
        to.name = edit.name;
        to.user = edit.user;
        to.time = edit.time;
        to.edits += 1;
        to.undoes = edit.undo;
        to.text = edit.text;
        for (const scene::Entry& entry : edit.entries) to.objects.push_back(scene::id(entry));
    }

    const std::string& wanted_;
    std::map<std::uint64_t, LoggedTransaction> transactions_;
    std::set<ObjectId> matching_;
    SessionLog log_;
};

}  // namespace

SessionLog read_session_log(const std::filesystem::path& folder, const std::string& object) {
    return Reader(object).read(folder);
}

}  // namespace tessera::master
