#include "master/scene/recovery.h"

#include <unistd.h>

#include <algorithm>
#include <fstream>

#include "master/scene/checkpoint_file.h"
#include "mediator/scene/blob_file.h"
#include "mediator/wire/journal_codec.h"

namespace tessera::master {

namespace {

namespace fs = std::filesystem;

class Recoverer {
  public:
    Recoverer(const fs::path& folder, SceneAuthority& authority, scene::BlobStore& blobs)
        : folder_(folder), authority_(authority), blobs_(blobs), files_(session_files(folder)) {}

    Recovery run() {
        if (files_.journals.empty() && files_.checkpoints.empty()) return {};
        recovery_.found = true;
        const std::uint64_t first = use_checkpoint();
        std::uint64_t expected = first;
        recovery_.next_segment = first;
        bool usable = true;
        for (const std::uint64_t number : files_.journals) {
            if (number < first) continue;
            if (usable && number != expected) {
                loss(journal_path(folder_, expected).string() + " is missing: later segments cannot be used");
                usable = false;
            }
            usable = usable ? replay(number) : keep_as_damaged(journal_path(folder_, number));
            expected = number + 1;
        }
        authority_.start_epoch();
        load_blobs();
        note(std::to_string(recovery_.edits) + " edits were replayed from the journal");
        return std::move(recovery_);
    }

  private:
    void note(std::string text) { recovery_.notes.push_back(std::move(text)); }
    void loss(std::string text) { recovery_.losses.push_back(std::move(text)); }

    // Returns the first segment after it.
    std::uint64_t use_checkpoint() {
        std::vector<fs::path> bad;
        for (auto number = files_.checkpoints.rbegin(); number != files_.checkpoints.rend(); ++number) {
            const fs::path path = checkpoint_path(folder_, *number);
            auto state = read_checkpoint(path, *number);
            if (state) {
                recovery_.scene = {state->title, state->owner};
                recovery_.views = std::move(state->views);
                check_films(path, state->render_revision);
                auto authority = restored(std::move(*state));
                if (authority) {
                    authority_.restore(std::move(*authority));
                    for (const fs::path& other : bad) keep_as_damaged(other);
                    note("checkpoint '" + path.string() + "' was used");
                    return *number;
                }
                state =
                    failure(ErrorCode::InvalidInput, "'" + path.string() + "': " + authority.error().what());
            }
            loss("checkpoint " + std::string(state.error().what()) + "; the previous one is used");
            bad.push_back(path);
        }
        const bool complete = !files_.journals.empty() && files_.journals.front() == 1;
        if (!complete) {
            throw Error(
                ErrorCode::InvalidInput,
                "no checkpoint in '" + folder_.string() +
                    "' is valid, and the journal before it was removed: move the folder away to start "
                    "a new session");
        }
        for (const fs::path& other : bad) keep_as_damaged(other);
        recovery_.scene = {};
        recovery_.views.clear();
        return 1;
    }

    // Views keep their cameras; film of another render revision starts again.
    void check_films(const fs::path& path, std::uint32_t revision) {
        if (revision == frame::RenderRevision) return;
        for (wire::SavedView& view : recovery_.views) view.blocks.clear();
        loss("checkpoint '" + path.string() + "' holds film of render revision " + std::to_string(revision) +
             ", this master merges revision " + std::to_string(frame::RenderRevision) +
             ": its views start again");
    }

    // False: later segments are unusable.
    bool replay(std::uint64_t number) {
        const fs::path path = journal_path(folder_, number);
        const JournalScan scan = read_journal(path, number, [&](std::span<const std::byte> bytes) {
            const auto record = wire::decode_journal_record(bytes);
            return record ? use(*record) : Expected<void>(tl::unexpected(record.error()));
        });
        if (scan.repaired != 0) {
            loss("journal '" + path.string() + "': the lengths of " + std::to_string(scan.repaired) +
                 " records had a wrong bit and are repaired; check the disk");
        }
        if (scan.end == JournalEnd::Complete || scan.records != 0) recovery_.next_segment = number + 1;
        if (scan.end == JournalEnd::Complete) return true;
        const bool last = number == files_.journals.back();
        if (scan.end == JournalEnd::Torn && last) {
            loss("journal " + scan.text +
                 ": an incomplete record at the end (the master crashed while writing it) is cut off");
        } else {
            loss("journal " + scan.text + ": everything from there on is lost");
        }
        cut(path, scan);
        return false;
    }

    Expected<void> use(const wire::JournalRecord& record) {
        if (auto replayed = authority_.replay(record); !replayed) return replayed;
        if (const auto* title = std::get_if<wire::RecordedTitle>(&record)) recovery_.scene = *title;
        if (const auto* edit = std::get_if<RecordedEdit>(&record))
            recovery_.edits += edit->editor != 0 ? 1 : 0;
        if (const auto* job = std::get_if<wire::RecordedJob>(&record)) {
            forget_job({job->view.owner_user, job->view.name});
            recovery_.views.push_back(job->view);
        }
        if (const auto* end = std::get_if<wire::RecordedJobEnd>(&record)) forget_job(end->job);
        if (std::holds_alternative<wire::RecordedClose>(record)) {
            recovery_.scene = {};
            recovery_.views.clear();
        }
        return {};
    }

    void forget_job(const session::JobName& job) {
        std::erase_if(recovery_.views, [&](const wire::SavedView& view) {
            return view.request.detached && view.owner_user == job.user && view.name == job.name;
        });
    }

    void cut(const fs::path& path, const JournalScan& scan) {
        if (scan.records == 0) {
            keep_as_damaged(path);
            return;
        }
        const fs::path tail = path.string() + ".tail-" + std::to_string(scan.offset);
        std::ifstream in(path, std::ios::binary);
        in.seekg(static_cast<std::streamoff>(scan.offset));
        std::ofstream out(tail, std::ios::binary);
        out << in.rdbuf();
        if (!out.flush() || ::truncate(path.c_str(), static_cast<off_t>(scan.offset)) != 0) {
            throw Error(ErrorCode::Io, "cannot cut the damaged end off '" + path.string() +
                                           "': check the folder, its rights and the free space");
        }
        force_to_disk(path);
    }

    bool keep_as_damaged(const fs::path& path) {
        std::error_code error;
        fs::rename(path, path.string() + ".damaged", error);
        if (error) {
            throw Error(ErrorCode::Io,
                        "cannot rename '" + path.string() + "' to .damaged: " + error.message());
        }
        fs::last_write_time(path.string() + ".damaged", fs::file_time_type::clock::now(), error);
        loss("'" + path.string() + "' is kept as .damaged");
        return false;
    }

    void load_blobs() {
        std::vector<scene::BlobRef> wanted = referenced_blobs(authority_.save());
        std::sort(wanted.begin(), wanted.end());
        wanted.erase(std::unique(wanted.begin(), wanted.end()), wanted.end());
        for (const scene::BlobRef& blob : wanted) {
            if (scene::BlobPtr found = scene::read_blob(blobs_path(folder_), blob)) {
                blobs_.insert(std::move(found));
            } else {
                loss("blob '" + scene::blob_path(blobs_path(folder_), blob).string() +
                     "' is missing or damaged: send the objects that need it again");
            }
        }
    }

    fs::path folder_;
    SceneAuthority& authority_;
    scene::BlobStore& blobs_;
    SessionFiles files_;
    Recovery recovery_;
};

}  // namespace

Recovery recover(const SessionFolder& folder, SceneAuthority& authority, scene::BlobStore& blobs) {
    return Recoverer(folder.path(), authority, blobs).run();
}

}  // namespace tessera::master
