#include "master/live_journal.h"

namespace tessera::master {

LiveJournal::LiveJournal(const std::filesystem::path& folder, Duration interval, SceneAuthority& authority,
                         std::shared_ptr<scene::BlobStore> blobs, LiveRunner& runner, EventSink events)
    : folder_(folder),
      interval_(interval),
      authority_(authority),
      runner_(runner),
      events_(std::move(events)),
      recovery_(recover(folder_, authority, *blobs)),
      writer_(folder) {
    for (const std::string& note : recovery_.notes) events_({wire::Severity::Info, note});
    journal_.emplace(folder, std::move(blobs), recovery_.next_segment);
}

void LiveJournal::opened(const std::string& title) {
    if (auto written = journal_->opened(title); !written) throw written.error();
    authority_.record_to(&*journal_);
    is_open_ = true;
}

void LiveJournal::closed() {
    authority_.record_to(nullptr);
    is_open_ = false;
}

void LiveJournal::tick(const std::string& title, TimePoint now) {
    if (const auto result = writer_.take_result()) {
        if (result->problem.empty()) {
            ++checkpoints_;
        } else {
            events_({wire::Severity::Error, "no checkpoint: " + result->problem});
        }
    }
    if (!is_open_) return;
    if (auto views = runner_.take_saved()) {
        try {
            const std::uint64_t number = journal_->start_segment();
            writer_.start({.number = number,
                           .title = title,
                           .authority = authority_.save(),
                           .views = std::move(*views)});
        } catch (const Error& error) {
            events_({wire::Severity::Error, std::string("no checkpoint: ") + error.what()});
        }
        last_ = now;
    }
    if (now - last_ < interval_ || writer_.busy() || runner_.is_saving()) return;
    const std::pair present(authority_.transactions(), runner_.film_progress());
    if (present == saved_) return;
    saved_ = present;
    runner_.save(authority_.state_hash());
}

}  // namespace tessera::master
