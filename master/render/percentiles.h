#pragma once

#include <cstdint>
#include <deque>

#include "mediator/base/clock.h"
#include "mediator/session/status.h"

namespace tessera::master {

// Percentiles of the latest durations.
class Percentiles {
  public:
    static constexpr std::size_t Length = 4096;

    void add(Duration duration);
    session::StageTimes summary(const std::string& name) const;  // nearest rank

  private:
    std::deque<Duration> latest_;
    std::uint64_t count_ = 0;
};

}  // namespace tessera::master
