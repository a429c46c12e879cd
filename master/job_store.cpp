#include "master/job_store.h"

#include <algorithm>
#include <latch>
#include <string>

#include "master/scene/hashed_file.h"
#include "mediator/base/hash.h"
#include "mediator/wire/journal_codec.h"

namespace tessera::master {

namespace {

namespace fs = std::filesystem;

constexpr HashedFileWriter::Magic JobMagic{'T', 'S', 'K', 'E', 'P', 'T', '0', '1'};
constexpr const char* Suffix = ".job";

void write(const fs::path& path, const wire::StoredJob& job, std::span<const std::byte> picture) {
    HashedFileWriter out(path, JobMagic);
    const std::vector<std::byte> bytes = wire::encode(job);
    out.put(std::uint64_t{bytes.size()});
    out.put(bytes);
    out.put(picture);
    out.finish();
}

}  // namespace

void JobStore::record_to(const fs::path& folder) {
    std::error_code problem;
    fs::create_directories(folder, problem);
    if (problem)
        throw Error(ErrorCode::Io,
                    "cannot create the folder '" + folder.string() + "': " + problem.message());
    std::vector<Entry> found;
    for (const fs::directory_entry& file : fs::directory_iterator(folder)) {
        if (file.path().extension() != Suffix) continue;
        try {
            HashedFile in(file.path(), JobMagic, "job");
            auto job = wire::decode_stored_job(in.take(in.number()));
            if (!job) throw job.error();
            found.push_back(
                {std::move(*job), std::make_shared<const std::vector<std::byte>>(in.take(in.remaining()))});
        } catch (const Error& error) {
            events_({wire::Severity::Warning,
                     "job '" + file.path().string() + "' cannot be used: " + error.what()});
        }
    }
    std::ranges::sort(found, {}, [](const Entry& entry) { return entry.job.status.ended_at; });
    for (Entry& entry : found) {
        bytes_ += entry.picture->size();
        entry.order = next_order_++;
        const session::JobName name = entry.job.status.job;
        jobs_.insert_or_assign(name, std::move(entry));
    }
    folder_ = folder;
    disk_ = std::make_unique<TaskThread>();
    evict_oldest();
}

JobStore::~JobStore() {
    if (!disk_) return;
    std::latch written(1);
    disk_->post([&] { written.count_down(); });
    written.wait();
}

fs::path JobStore::path_of(const session::JobName& job) const {
    const std::string key = std::to_string(job.user.size()) + ":" + job.user + job.name;
    return folder_ / (to_hex(blake2b(std::as_bytes(std::span(key)))) + Suffix);
}

void JobStore::add(wire::StoredJob&& job, std::shared_ptr<const std::vector<std::byte>> picture) {
    const session::JobName name = job.status.job;
    (void)remove(name);
    bytes_ += picture->size();
    const Entry& entry =
        jobs_.emplace(name, Entry{std::move(job), std::move(picture), next_order_++}).first->second;
    if (disk_) {
        disk_->post([this, path = path_of(name), entry, events = events_] {
            try {
                write(path, entry.job, *entry.picture);
                const std::scoped_lock lock(mutex_);
                written_.push_back(entry.job.status.job);
            } catch (const std::exception& error) {
                events({wire::Severity::Error,
                        "job '" + entry.job.status.job.name + "' is kept in memory only: " + error.what()});
            }
        });
    }
    evict_oldest();
}

const JobStore::Entry* JobStore::find(const session::JobName& job) const {
    const auto found = jobs_.find(job);
    return found == jobs_.end() ? nullptr : &found->second;
}

bool JobStore::remove(const session::JobName& job) {
    const auto found = jobs_.find(job);
    if (found == jobs_.end()) return false;
    bytes_ -= found->second.picture->size();
    jobs_.erase(found);
    if (disk_) {
        disk_->post([path = path_of(job)] {
            std::error_code ignored;
            fs::remove(path, ignored);
        });
    }
    return true;
}

std::string JobStore::unused_name(const session::JobName& job) const {
    session::JobName candidate = job;
    for (int number = 2; jobs_.contains(candidate); ++number)
        candidate.name = job.name + " (" + std::to_string(number) + ")";
    return candidate.name;
}

void JobStore::remove_expired(std::int64_t since_1970, TimePoint now) {
    std::vector<session::JobName> expired;
    for (auto& [name, entry] : jobs_) {
        const session::JobStatus& status = entry.job.status;
        if (status.kept_until == 0) continue;
        if (!entry.expires) {
            const std::int64_t longest = std::max<std::int64_t>(0, status.kept_until - status.ended_at);
            entry.expires =
                now + Duration(std::clamp<std::int64_t>(status.kept_until - since_1970, 0, longest));
        }
        if (*entry.expires <= now) expired.push_back(name);
    }
    for (const session::JobName& job : expired) {
        events_({wire::Severity::Info,
                 "job '" + job.name + "' of " + job.user + " is removed: no client fetched it in time"});
        (void)remove(job);
    }
}

std::vector<session::JobName> JobStore::take_written() {
    const std::scoped_lock lock(mutex_);
    return std::exchange(written_, {});
}

std::vector<const JobStore::Entry*> JobStore::all() const {
    std::vector<const Entry*> entries;
    for (const auto& [name, entry] : jobs_) entries.push_back(&entry);
    std::ranges::sort(entries, {}, &Entry::order);
    return entries;
}

void JobStore::evict_oldest() {
    while (jobs_.size() > 1 && (jobs_.size() > MaxJobs || bytes_ > MaxBytes)) {
        const session::JobName oldest = all().front()->job.status.job;
        events_({wire::Severity::Warning, "job '" + oldest.name + "' of " + oldest.user +
                                              " is removed: the limit of stored jobs is reached"});
        (void)remove(oldest);
    }
}

}  // namespace tessera::master
