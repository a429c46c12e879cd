#pragma once

#include <atomic>
#include <filesystem>

#include "tests/cluster/link_switch.h"
#include "tests/fuzz/random_values.h"

namespace tessera::test {

// Misbehaviour of honest nodes' links and of the disk, seeded, measured in messages that the peers send.
class Faults {
  public:
    // `folder`: the session folder, on a disk that becomes full at times.
    Faults(const std::filesystem::path& folder, std::uint64_t seed) : folder_(folder), random_(seed) {}
    ~Faults() { heal(); }
    Faults(const Faults&) = delete;
    Faults& operator=(const Faults&) = delete;

    void step(LinkSwitch& one, LinkSwitch& other);  // a message was sent
    void heal();
    // Odd while the disk is full; grows with each change. Thread-safe.
    std::uint64_t disk_changes() const { return disk_changes_; }
    std::uint64_t count() const { return count_; }  // of faults so far

  private:
    void fill_disk();
    void empty_disk();

    const std::filesystem::path folder_;
    RandomValues random_;
    std::uint64_t left_ = 0, count_ = 0;  // messages until the present fault ends
    LinkSwitch* stalled_ = nullptr;
    std::atomic<std::uint64_t> disk_changes_ = 0;
};

}  // namespace tessera::test
