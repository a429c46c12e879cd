#include "master/peers/quarantine.h"

#include <algorithm>

namespace tessera::master {

namespace {
constexpr std::size_t MaxEntries = 4096;
}

Quarantine::Entry& Quarantine::note(const Key& node, const std::string& reason, TimePoint now) {
    if (entries_.size() >= MaxEntries && !entries_.contains(node)) {
        entries_.erase(std::min_element(entries_.begin(), entries_.end(), [](const auto& a, const auto& b) {
            return a.second.last_fault < b.second.last_fault;
        }));
    }
    Entry& entry = entries_[node];
    if (now - entry.last_fault > settings_.forgiven_after) entry.faults = 0;
    if (now - entry.last_fault > 2 * settings_.longest) entry.times = 0;
    entry.last_fault = now;
    entry.reason = reason;
    return entry;
}

bool Quarantine::fault(const Key& node, const std::string& reason, TimePoint now) {
    Entry& entry = note(node, reason, now);
    if (++entry.faults < settings_.fault_limit) return false;
    begin(entry, now);
    return true;
}

void Quarantine::begin(const Key& node, const std::string& reason, TimePoint now) {
    begin(note(node, reason, now), now);
}

void Quarantine::begin(Entry& entry, TimePoint now) {
    // The next fault after its return is enough for another time.
    entry.faults = settings_.fault_limit - 1;
    Duration time = settings_.first;
    for (std::uint32_t i = 0; i < entry.times && time < settings_.longest; ++i) time *= 2;
    ++entry.times;
    entry.until = now + std::min(time, settings_.longest);
}

const Quarantine::Entry* Quarantine::find(const Key& node, TimePoint now) const {
    const auto entry = entries_.find(node);
    const bool holds = entry != entries_.end() && entry->second.until && now < *entry->second.until;
    return holds ? &entry->second : nullptr;
}

const Quarantine::Entry* Quarantine::faults(const Key& node, TimePoint now) const {
    const auto entry = entries_.find(node);
    const bool is_forgiven =
        entry == entries_.end() || now - entry->second.last_fault > settings_.forgiven_after;
    return is_forgiven || entry->second.faults == 0 ? nullptr : &entry->second;
}

bool Quarantine::release(const std::string& name, TimePoint now) {
    bool released = false;
    std::erase_if(entries_, [&](const auto& entry) {
        const bool is_it = entry.first.second == name && entry.second.until && now < *entry.second.until;
        released = released || is_it;
        return is_it;
    });
    return released;
}

}  // namespace tessera::master
