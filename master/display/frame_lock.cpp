#include "master/display/frame_lock.h"

#include <algorithm>

namespace tessera::master {

using session::OutputState;

namespace {
constexpr std::size_t KeptTimes = 64;
}

void FrameLock::joined(std::size_t output) {
    outputs_[output].state = OutputState::Joining;
    outputs_[output].in_flight = 0;
    waiting_.erase(output);
    ready_.erase(output);
}

std::optional<FrameLock::Present> FrameLock::left(std::size_t output, TimePoint now) {
    outputs_[output].state = OutputState::Absent;
    outputs_[output].in_flight = 0;
    waiting_.erase(output);
    ready_.erase(output);
    return present_if_all_ready(now);
}

bool FrameLock::has_joining() const {
    return std::any_of(outputs_.begin(), outputs_.end(),
                       [](const Output& output) { return output.state == OutputState::Joining; });
}

std::vector<std::size_t> FrameLock::begin(std::uint64_t frame, Recipients recipients, TimePoint now) {
    std::vector<std::size_t> receivers;
    for (std::size_t i = 0; i < outputs_.size(); ++i) {
        Output& output = outputs_[i];
        const bool is_locked = output.state == OutputState::Locked && recipients == Recipients::All;
        if (output.state != OutputState::Joining && !is_locked) continue;
        output.state = OutputState::Locked;
        output.in_flight = frame;
        output.sent_at = now;
        receivers.push_back(i);
    }
    waiting_ = {receivers.begin(), receivers.end()};
    ready_.clear();
    frame_ = receivers.empty() ? 0 : frame;
    is_new_ = recipients == Recipients::All;
    last_sign_ = now;
    pause_ = Duration::zero();
    return receivers;
}

std::optional<FrameLock::Present> FrameLock::ready(std::size_t i, std::uint64_t frame, TimePoint now) {
    Output& output = outputs_[i];
    if (output.in_flight == 0 || frame < output.in_flight) return std::nullopt;
    output.in_flight = 0;
    if (output.state == OutputState::Late) {
        output.state = OutputState::Joining;
        const Duration took = std::min(now - output.sent_at, settings_.max_timeout / 2);
        expected_ = std::max(expected_.value_or(took), took);
    }
    if (frame != frame_ || waiting_.erase(i) == 0) return std::nullopt;
    ready_.insert(i);
    pause_ = std::max(pause_, now - last_sign_);
    last_sign_ = now;
    return present_if_all_ready(now);
}

std::optional<FrameLock::Present> FrameLock::tick(TimePoint now) {
    if (frame_ == 0 || now - last_sign_ < timeout()) return std::nullopt;
    for (const std::size_t i : waiting_) {
        outputs_[i].state = OutputState::Late;
        ++outputs_[i].late;
    }
    waiting_.clear();
    return present_if_all_ready(now);
}

std::optional<FrameLock::Present> FrameLock::present_if_all_ready(TimePoint now) {
    if (frame_ == 0 || !waiting_.empty()) return std::nullopt;
    Present present{.frame = frame_, .at = {}, .outputs = {ready_.begin(), ready_.end()}};
    frame_ = 0;
    constexpr int Forgets = 16;  // decays to a third after this many frames
    expected_ = std::max(pause_, expected_.value_or(Duration::zero()) * (Forgets - 1) / Forgets);
    if (present.outputs.empty()) return std::nullopt;
    Duration lead = settings_.min_lead;
    for (const std::size_t i : present.outputs) {
        // The message takes at most a round trip, twice the bound of the clock offset.
        lead = std::max(lead, 2 * outputs_[i].bound);
        ++outputs_[i].frames;
    }
    present.at = std::max(now + std::min(lead, settings_.max_lead), last_at_ + interval_);
    if (!is_new_) return present;
    last_at_ = present.at;
    ++frames_;
    presented_.push_back(present.at);
    if (presented_.size() > KeptTimes) presented_.erase(presented_.begin());
    return present;
}

double FrameLock::rate(TimePoint now) const {
    constexpr Duration Recent = std::chrono::seconds(2);
    const auto first =
        std::find_if(presented_.begin(), presented_.end(), [&](TimePoint at) { return now - at < Recent; });
    if (presented_.end() - first < 2) return 0.0;
    return static_cast<double>(presented_.end() - first - 1) / seconds(presented_.back() - *first);
}

}  // namespace tessera::master
