#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "master/peers/event.h"
#include "mediator/base/clock.h"

namespace tessera::master {

// Printable: control characters, also those of UTF-8, become \xNN, and long texts are cut. Peers choose parts of the
// texts; none may begin a line of its own in the log, or move the cursor of a terminal.
std::string escaped(const std::string& text);

// Events for the log, escaped and limited in rate: of those that begin alike, `PerSecond` a second, and `AllPerSecond` of
// all, since peers choose names with which texts begin; then one line says how many were left out. Thread-safe.
class EventLimiter {
  public:
    static constexpr int PerSecond = 20, AllPerSecond = 200;
    EventLimiter(const Clock& clock, EventSink sink) : clock_(clock), sink_(std::move(sink)) {}
    void operator()(const Event& event);
    void tick();  // reports what was left out, once a second has passed

  private:
    struct Recent {
        TimePoint since{};
        int passed = 0;
        std::uint64_t left_out = 0;
        wire::Severity severity = wire::Severity::Info;
    };
    void report(const std::string& beginning, const Recent& recent);

    const Clock& clock_;
    EventSink sink_;
    bool passes(Recent& recent, int limit, const std::string& beginning, const Event& event, TimePoint now);

    std::mutex mutex_;  // protects the members below
    std::map<std::string, Recent> recent_;
    Recent all_;
};

}  // namespace tessera::master
