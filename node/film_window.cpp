#include "node/film_window.h"

#include <algorithm>

namespace tessera::node {

void FilmWindow::sent(std::uint64_t bytes, TimePoint now) {
    sent_ += bytes;
    messages_.push_back({sent_, now, !has_room()});
}

void FilmWindow::taken(std::uint64_t bytes, TimePoint now) {
    if (bytes <= taken_ || bytes > sent_) return;  // old, or of an earlier link
    const std::uint64_t fresh = bytes - taken_;
    taken_ = bytes;
    Duration delay{};
    bool filled_window = false;
    while (!messages_.empty() && messages_.front().end <= taken_) {
        delay = now - messages_.front().sent_at;
        filled_window = filled_window || messages_.front().filled_window;
        messages_.pop_front();
    }
    if (delay > Target) {
        if (taken_ < shrink_again_at_) return;
        const double factor = std::max(0.5, double(Target.count()) / double(delay.count()));
        size_ = std::max(Smallest, static_cast<std::uint64_t>(factor * double(size_)));
        shrink_again_at_ = sent_;
    } else if (filled_window) {
        size_ = std::min(Largest, size_ + fresh);
    }
}

void FilmWindow::restart() {
    sent_ = taken_ = shrink_again_at_ = 0;
    messages_.clear();
}

}  // namespace tessera::node
