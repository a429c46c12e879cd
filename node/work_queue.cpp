#include "node/work_queue.h"

#include <algorithm>

namespace tessera::node {

namespace {

constexpr std::size_t Overrun =
    64;  // units accepted beyond the slots: credits may be in transit when the slots change

auto with_id(UnitId id) {
    return [id](const view::WorkUnit& unit) { return unit.id == id; };
}

}  // namespace

WorkQueue::AdmitResult WorkQueue::admit(std::uint64_t sequence, const view::WorkUnit& unit) {
    if (sequence <= last_sequence_) return AdmitResult::Duplicate;
    last_sequence_ = sequence;
    if (is_waiting(unit.id) || is_rendering(unit.id) || held_.contains(unit.id) || sending_.contains(unit.id))
        return AdmitResult::Duplicate;
    if (waiting_.size() >= slots_ + Overrun) return AdmitResult::Full;
    waiting_.push_back(unit);
    return AdmitResult::Accepted;
}

std::optional<view::WorkUnit> WorkQueue::next(Version version) {
    if (rendering_.size() >= workers_) return std::nullopt;
    const auto found = std::find_if(waiting_.begin(), waiting_.end(),
                                    [&](const auto& unit) { return unit.version == version; });
    if (found == waiting_.end()) return std::nullopt;
    rendering_.push_back(*found);
    waiting_.erase(found);
    return rendering_.back();
}

std::optional<view::WorkUnit> WorkQueue::rendered(UnitId id) {
    const auto found = std::find_if(rendering_.begin(), rendering_.end(), with_id(id));
    if (found == rendering_.end()) return std::nullopt;
    const view::WorkUnit unit = *found;
    rendering_.erase(found);
    sending_.insert(id);
    return unit;
}

void WorkQueue::hold(UnitId id) {
    if (sending_.erase(id) > 0) held_.insert(id);
}

void WorkQueue::unhold(UnitId id) {
    if (held_.erase(id) > 0) sending_.insert(id);
}

void WorkQueue::release(UnitId id) {
    std::erase_if(waiting_, with_id(id));
    held_.erase(id);
    sending_.erase(id);
}

bool WorkQueue::is_waiting(UnitId id) const {
    return std::any_of(waiting_.begin(), waiting_.end(), with_id(id));
}

bool WorkQueue::is_rendering(UnitId id) const {
    return std::any_of(rendering_.begin(), rendering_.end(), with_id(id));
}

std::vector<UnitId> WorkQueue::in_flight() const {
    std::vector<UnitId> ids(sending_.begin(), sending_.end());
    ids.insert(ids.end(), held_.begin(), held_.end());
    for (const view::WorkUnit& unit : waiting_) ids.push_back(unit.id);
    for (const view::WorkUnit& unit : rendering_) ids.push_back(unit.id);
    std::sort(ids.begin(), ids.end());
    return ids;
}

std::uint32_t WorkQueue::free_slots() const {
    const std::size_t held = waiting_.size() + rendering_.size() + sending_.size();
    return held >= slots_ ? 0 : slots_ - static_cast<std::uint32_t>(held);
}

}  // namespace tessera::node
