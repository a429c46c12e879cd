#include "master/scene/session_journal.h"

#include <algorithm>

namespace tessera::master {

SessionJournal::SessionJournal(const std::filesystem::path& folder, Duration interval,
                               SceneAuthority& authority, std::shared_ptr<scene::BlobStore> blobs,
                               EventSink events)
    : folder_(folder),
      interval_(interval),
      authority_(authority),
      events_(std::move(events)),
      recovery_(recover(folder_, authority, *blobs)),
      stored_(std::make_shared<StoredBlobs>(folder, blobs)),
      writer_(folder, stored_, folder_.lease()) {
    for (const std::string& note : recovery_.notes) events_({wire::Severity::Info, note});
    for (const std::string& loss : recovery_.losses) events_({wire::Severity::Warning, loss});
    journal_.emplace(folder, std::move(blobs), recovery_.next_segment, stored_, folder_.lease());
}

void SessionJournal::opened(const wire::RecordedTitle& scene) {
    if (auto written = journal_->opened(scene); !written) throw written.error();
    authority_.record_to(&*journal_);
    is_open_ = true;
}

void SessionJournal::closed() {
    authority_.record_to(nullptr);
    is_open_ = false;
}

void SessionJournal::tick() {
    if (!lost_) {
        const std::string problem = folder_.lease()->lost_reason();
        lost_ = !problem.empty();
        if (lost_) events_({wire::Severity::Error, problem});
    }
    const auto result = writer_.take_result();
    if (!result) return;
    last_write_failed_ = !result->problem.empty();
    if (last_write_failed_) {
        events_({wire::Severity::Error, "no checkpoint: " + result->problem});
        return;  // tried again after the interval
    }
    ++checkpoints_;
    saved_ = being_saved_;
    if (!journal_->problem().empty() && journal_->failures() == failures_at_start_) {
        journal_->recovered();
        events_({wire::Severity::Info, "the session is on disk again: edits are accepted"});
    }
}

bool SessionJournal::has_news(std::uint64_t film_progress) const {
    return is_open_ && !lost_ && !writer_.busy() &&
           saved_ != std::pair(authority_.transactions(), film_progress);
}

bool SessionJournal::wants_checkpoint(std::uint64_t film_progress, TimePoint now) const {
    constexpr Duration RetryInterval = std::chrono::seconds(1);
    const bool is_broken = is_open_ && !lost_ && !writer_.busy() && !journal_->problem().empty();
    if (is_broken) return now - last_ >= std::min(interval_, RetryInterval);
    return now - last_ >= interval_ && has_news(film_progress);
}

void SessionJournal::write_checkpoint(const wire::RecordedTitle& scene, std::vector<wire::SavedView>&& views,
                                      std::uint64_t film_progress, TimePoint now) {
    last_ = now;
    being_saved_ = {authority_.transactions(), film_progress};
    if (!is_open_) return;
    failures_at_start_ = journal_->failures();
    try {
        const std::uint64_t number = journal_->start_segment();
        writer_.start(
            {.number = number, .scene = scene, .authority = authority_.save(), .views = std::move(views)});
    } catch (const Error& error) {
        events_({wire::Severity::Error, std::string("no checkpoint: ") + error.what()});
    }
}

}  // namespace tessera::master
