#include "master/scene/stored_blobs.h"

#include <algorithm>
#include <charconv>
#include <iterator>
#include <optional>
#include <string>
#include <vector>

#include "master/scene/session_folder.h"
#include "mediator/scene/blob_file.h"

namespace tessera::master {

namespace fs = std::filesystem;

namespace {

// Of the name of its file; temporary files have others.
std::optional<Hash256> hash_in(const std::string& name) {
    Hash256 hash;
    if (name.size() != 2 * hash.bytes.size()) return std::nullopt;
    for (std::size_t i = 0; i < hash.bytes.size(); ++i) {
        const char* digits = name.data() + 2 * i;
        std::uint8_t byte = 0;
        if (std::from_chars(digits, digits + 2, byte, 16).ptr != digits + 2) return std::nullopt;
        hash.bytes[i] = static_cast<std::remove_reference_t<decltype(hash.bytes[i])>>(byte);
    }
    if (to_hex(hash) != name) return std::nullopt;
    return hash;
}

}  // namespace

StoredBlobs::StoredBlobs(fs::path session_folder, std::shared_ptr<const scene::BlobStore> blobs)
    : folder_(std::move(session_folder)), blobs_(std::move(blobs)) {}

bool StoredBlobs::use(const Hash256& blob, std::uint64_t segment) {
    const std::scoped_lock lock(mutex_);
    used_[blob] = segment;
    return kept_.contains(blob);
}

Expected<void> StoredBlobs::write(const scene::Blob& blob) {
    const auto is_lost = [&] {
        const std::scoped_lock lock(mutex_);
        return lost_.contains(blob.hash());
    };
    // Not locked: remove_unused() leaves what is in use.
    const fs::path folder = blobs_path(folder_);
    if (auto written = is_lost() ? scene::replace_blob(folder, blob) : scene::write_blob(folder, blob);
        !written)
        return written;
    const std::scoped_lock lock(mutex_);
    kept_.insert(blob.hash());
    lost_.erase(blob.hash());
    return {};
}

void StoredBlobs::sync_failed(const Hash256& blob) {
    const std::scoped_lock lock(mutex_);
    kept_.erase(blob);
    lost_.insert(blob);
}

void StoredBlobs::sync_failed_of_all() {
    const std::scoped_lock lock(mutex_);
    lost_.merge(kept_);
    kept_.clear();
}

void StoredBlobs::write_lost_again(const std::set<Hash256>& referenced) {
    std::set<Hash256> lost;
    {
        const std::scoped_lock lock(mutex_);
        std::ranges::set_intersection(lost_, referenced, std::inserter(lost, lost.end()));
    }
    for (const Hash256& hash : lost) {
        const scene::BlobPtr blob = blobs_->find(hash);
        if (!blob) {
            throw Error(ErrorCode::NotFound,
                        "blob " + to_hex(hash) + " could not be synced, and is no longer in memory");
        }
        if (auto written = write(*blob); !written) throw written.error();
    }
}

void StoredBlobs::scene_closed() {
    const std::scoped_lock lock(mutex_);
    kept_.clear();
}

void StoredBlobs::written(std::uint64_t checkpoint, std::set<Hash256>&& blobs) {
    const std::scoped_lock lock(mutex_);
    checkpoints_[checkpoint] = std::move(blobs);
    while (checkpoints_.size() > 2) checkpoints_.erase(checkpoints_.begin());
}

std::size_t StoredBlobs::remove_unused() {
    const SessionFiles files = session_files(folder_);
    {
        const std::scoped_lock lock(mutex_);
        const bool are_known = files.checkpoints.size() == 2 &&
                               std::ranges::all_of(files.checkpoints, [&](std::uint64_t number) {
                                   return checkpoints_.contains(number);
                               });
        if (!are_known) return 0;
    }
    const std::uint64_t older = files.checkpoints.front();
    if (!files.journals.empty() && files.journals.front() < older) return 0;
    std::vector<std::string> names;
    std::error_code error;
    for (fs::directory_iterator place(blobs_path(folder_), error), end; !error && place != end;
         place.increment(error))
        names.push_back(place->path().filename().string());
    std::size_t removed = 0;
    for (const std::string& name : names) {
        const std::optional<Hash256> hash = hash_in(name);
        if (!hash) continue;
        // Locked until the file is gone: an edit that refers to it from then on writes it again.
        const std::scoped_lock lock(mutex_);
        const auto used = used_.find(*hash);
        const bool is_journaled = used != used_.end() && used->second >= older;
        const bool is_referenced = std::ranges::any_of(
            checkpoints_, [&](const auto& checkpoint) { return checkpoint.second.contains(*hash); });
        if (is_journaled || is_referenced || !fs::remove(blobs_path(folder_) / name, error)) continue;
        kept_.erase(*hash);
        lost_.erase(*hash);
        used_.erase(*hash);
        ++removed;
    }
    return removed;
}

}  // namespace tessera::master
