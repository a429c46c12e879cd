#include "master/scene/checkpoint_writer.h"

#include <cassert>
#include <exception>
#include <utility>

#include "master/scene/checkpoint_file.h"
#include "master/scene/session_folder.h"
#include "mediator/base/clock.h"

namespace tessera::master {

CheckpointWriter::CheckpointWriter(std::filesystem::path folder, std::shared_ptr<StoredBlobs> stored,
                                   std::shared_ptr<FolderLease> lease)
    : folder_(std::move(folder)),
      stored_(std::move(stored)),
      lease_(std::move(lease)),
      thread_([this](const std::stop_token& stop) { run(stop); }) {}

CheckpointWriter::~CheckpointWriter() {
    wait();
    thread_.request_stop();
    thread_.join();
}

bool CheckpointWriter::busy() const {
    const std::scoped_lock lock(mutex_);
    return busy_;
}

void CheckpointWriter::start(CheckpointJob job) {
    const std::scoped_lock lock(mutex_);
    assert(!busy_);
    job_ = std::move(job);
    busy_ = true;
    changed_.notify_all();
}

void CheckpointWriter::wait() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return !busy_; });
}

std::optional<CheckpointResult> CheckpointWriter::take_result() {
    const std::scoped_lock lock(mutex_);
    return std::exchange(result_, std::nullopt);
}

void CheckpointWriter::run(const std::stop_token& stop) {
    std::unique_lock lock(mutex_);
    while (changed_.wait(lock, stop, [&] { return job_.has_value(); })) {
        CheckpointJob job = std::move(*job_);
        job_.reset();
        lock.unlock();
        CheckpointResult result = write(std::move(job));
        lock.lock();
        result_ = std::move(result);
        busy_ = false;
        changed_.notify_all();
    }
}

void CheckpointWriter::check_lease() const {
    const std::string problem = lease_ ? lease_->problem() : std::string();
    if (!problem.empty()) throw Error(ErrorCode::Unavailable, problem);
}

CheckpointResult CheckpointWriter::write(CheckpointJob job) const {
    const TimePoint begin = SteadyClock().now();
    CheckpointResult result{.number = job.number};
    try {
        wire::CheckpointState state = recorded(job.authority);
        state.journal = job.number;
        state.title = std::move(job.scene.title);
        state.owner = std::move(job.scene.owner);
        state.views = std::move(job.views);
        std::set<Hash256> blobs;
        for (const scene::BlobRef& blob : referenced_blobs(job.authority)) blobs.insert(blob.hash);
        check_lease();
        if (stored_) stored_->write_lost_again(blobs);
        result.byte_size = write_checkpoint(checkpoint_path(folder_, job.number), job.number, state);
        check_lease();
        remove_outdated(folder_);
        if (stored_) {
            stored_->written(job.number, std::move(blobs));
            stored_->remove_unused();
        }
    } catch (const std::exception& error) {
        result.problem = error.what();
    }
    result.seconds = seconds(SteadyClock().now() - begin);
    return result;
}

}  // namespace tessera::master
