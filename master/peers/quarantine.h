#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "mediator/base/clock.h"

namespace tessera::master {

struct QuarantineSettings {
    std::uint32_t fault_limit = 3;
    Duration forgiven_after = std::chrono::minutes(10);  // a fault, if no other follows
    Duration first = std::chrono::minutes(1), longest = std::chrono::hours(1);
};

// Nodes that get no work for a while, because they failed at what others manage or sent film that they were not asked
// for. Each time takes twice as long as the one before. A node is known by its user and name, so reconnecting does not
// help it. Pure.
class Quarantine {
  public:
    using Key = std::pair<std::string, std::string>;  // user, name
    struct Entry {
        std::string reason;  // of the latest fault
        std::uint32_t faults = 0;
        std::uint32_t times = 0;  // in quarantine
        TimePoint last_fault{};
        std::optional<TimePoint> until;  // in quarantine
    };

    explicit Quarantine(const QuarantineSettings& settings = {}) : settings_(settings) {}

    // Returns true if the node is in quarantine from now on.
    bool fault(const Key& node, const std::string& reason, TimePoint now);
    // Puts it into quarantine at once: there is a proof.
    void begin(const Key& node, const std::string& reason, TimePoint now);
    // Null: it is not in quarantine.
    const Entry* find(const Key& node, TimePoint now) const;
    // Null: nothing is held against it.
    const Entry* faults(const Key& node, TimePoint now) const;
    // Ends that of all nodes with this name. False: none is in quarantine.
    bool release(const std::string& name, TimePoint now);

  private:
    Entry& note(const Key& node, const std::string& reason, TimePoint now);
    void begin(Entry& entry, TimePoint now);

    QuarantineSettings settings_;
    std::map<Key, Entry> entries_;  // bounded
};

}  // namespace tessera::master
