#include "master/guard.h"

namespace tessera::master {

void Guard::caught(std::string_view what, const char* problem) {
    ++caught_;
    const TimePoint now = clock_.now();
    auto recent = recent_.find(what);
    if (recent == recent_.end()) recent = recent_.emplace(what, Recent{}).first;
    Recent& entry = recent->second;
    if (entry.logged != TimePoint{} && now - entry.logged < std::chrono::seconds(1)) {
        ++entry.silent;
        return;
    }
    std::string text = std::string(what) + " failed, the master goes on: " + problem;
    if (entry.silent > 0) text += " (and " + std::to_string(entry.silent) + " times since the last message)";
    entry = {now, 0};
    events_({wire::Severity::Error, std::move(text)});
}

}  // namespace tessera::master
