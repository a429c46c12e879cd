#include "master/scene/journal.h"

#include <fcntl.h>

#include "mediator/scene/blob_file.h"
#include "mediator/scene/scene.h"
#include "mediator/wire/journal_codec.h"

namespace tessera::master {

Journal::Journal(const std::filesystem::path& folder, std::shared_ptr<const scene::BlobStore> blobs,
                 std::uint64_t segment, std::shared_ptr<StoredBlobs> stored,
                 std::shared_ptr<FolderLease> lease, Duration sync_interval)
    : folder_(folder),
      blobs_(std::move(blobs)),
      number_(segment),
      segment_(journal_path(folder, segment), segment),
      stored_(stored ? std::move(stored) : std::make_shared<StoredBlobs>(folder, blobs_)),
      lease_(std::move(lease)),
      sync_(sync_interval) {
    sync_.soon(segment_.file());
    sync_folder(folder_);
}

void Journal::sync_folder(const std::filesystem::path& folder, std::function<void()> failed) {
    const auto file =
        std::make_shared<FileHandle>(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
    if (file->descriptor() >= 0) sync_.soon(file, std::move(failed));
}

Expected<void> Journal::check_disk() const {
    const std::string problem = sync_.problem();
    if (problem.empty()) return {};
    return failure(ErrorCode::Io, problem + "; edits are accepted again when a checkpoint can be written");
}

Expected<void> Journal::append(const wire::JournalRecord& record) {
    if (auto checked = check_disk(); !checked) return checked;
    std::vector<std::byte> bytes;
    try {
        bytes = wire::encode(record);
    } catch (const Error& error) {
        return tl::unexpected(error);
    }
    if (lease_) {
        if (const std::string problem = lease_->problem(); !problem.empty())
            return failure(ErrorCode::Unavailable, problem);
    }
    if (auto appended = segment_.append(bytes); !appended) return appended;
    sync_.soon(segment_.file());
    return {};
}

Expected<void> Journal::keep_blobs(const std::vector<scene::Entry>& entries) {
    bool wrote = false;
    for (const scene::Entry& entry : entries) {
        for (const scene::BlobRef& reference : scene::referenced_blobs(entry)) {
            if (stored_->use(reference.hash, number_)) continue;
            const scene::BlobPtr blob = blobs_->find(reference.hash);
            if (!blob) {
                return failure(ErrorCode::NotFound,
                               "blob " + to_hex(reference.hash) + " is no longer stored: send it again");
            }
            const std::filesystem::path folder = blobs_path(folder_);
            if (auto written = stored_->write(*blob); !written) return written;
            const auto file = std::make_shared<FileHandle>(
                ::open(scene::blob_path(folder, reference).c_str(), O_RDONLY | O_CLOEXEC));
            if (file->descriptor() >= 0) {
                sync_.soon(file, [stored = stored_, hash = reference.hash] { stored->sync_failed(hash); });
            } else {
                stored_->sync_failed(reference.hash);
            }
            wrote = true;
        }
    }
    if (wrote) sync_folder(blobs_path(folder_), [stored = stored_] { stored->sync_failed_of_all(); });
    return {};
}

Expected<void> Journal::joined(const wire::RecordedEditor& editor) {
    return append(editor);
}

Expected<void> Journal::edited(const RecordedEdit& edit) {
    if (auto checked = check_disk(); !checked) return checked;
    if (auto kept = keep_blobs(edit.entries); !kept) return kept;
    return append(edit);
}

void Journal::cleared() {
    (void)append(wire::RecordedClose{});  // unwritten: a restart finds the scene as it was
    stored_->scene_closed();
}

Expected<void> Journal::opened(const wire::RecordedTitle& scene) {
    return append(scene);
}

Expected<void> Journal::job_started(wire::SavedView view) {
    return append(wire::RecordedJob{std::move(view)});
}

Expected<void> Journal::job_ended(const session::JobName& job) {
    return append(wire::RecordedJobEnd{job});
}

std::uint64_t Journal::start_segment() {
    if (lease_) {
        if (const std::string problem = lease_->problem(); !problem.empty())
            throw Error(ErrorCode::Unavailable, problem);
    }
    JournalFile next(journal_path(folder_, number_ + 1), number_ + 1);
    earlier_bytes_ += segment_.byte_size();
    segment_ = std::move(next);
    ++number_;
    sync_.soon(segment_.file());
    sync_folder(folder_);
    return number_;
}

}  // namespace tessera::master
