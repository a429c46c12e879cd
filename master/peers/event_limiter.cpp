#include "master/peers/event_limiter.h"

#include <algorithm>

namespace tessera::master {

namespace {

constexpr std::size_t MaxText = 2000;
constexpr std::size_t BeginningLength = 24;  // of texts that count as alike
constexpr std::size_t MaxBeginnings = 1024;

void put_escaped(std::string& out, unsigned char byte) {
    constexpr char Digits[] = "0123456789abcdef";
    out += "\\x";
    out += Digits[byte >> 4];
    out += Digits[byte & 15];
}

Event escaped(Event event) {
    event.text = master::escaped(event.text);
    event.about.node = master::escaped(event.about.node);
    return event;
}

}  // namespace

std::string escaped(const std::string& text) {
    std::string out;
    for (std::size_t i = 0; i < text.size() && out.size() < MaxText; ++i) {
        const auto byte = static_cast<unsigned char>(text[i]);
        const bool is_control = byte < 0x20 || byte == 0x7f;
        // U+0080 to U+009F are C2 80 to C2 9F; terminals obey some of them.
        const bool is_c1 =
            byte == 0xc2 && i + 1 < text.size() && static_cast<unsigned char>(text[i + 1]) < 0xa0;
        if (is_control) {
            put_escaped(out, byte);
        } else if (is_c1) {
            put_escaped(out, byte);
            put_escaped(out, static_cast<unsigned char>(text[++i]));
        } else {
            out += text[i];
        }
    }
    if (out.size() >= MaxText) out += "...";
    return out;
}

bool EventLimiter::passes(Recent& recent, int limit, const std::string& beginning, const Event& event,
                          TimePoint now) {
    if (now - recent.since >= std::chrono::seconds(1)) {
        if (recent.left_out > 0) report(beginning, recent);
        recent = {.since = now, .passed = 0, .left_out = 0, .severity = event.severity};
    }
    if (recent.passed >= limit) {
        ++recent.left_out;
        return false;
    }
    ++recent.passed;
    return true;
}

void EventLimiter::operator()(const Event& event) {
    if (event.is_detail)
        return sink_(escaped(event));  // there are no more of these than the master deals units
    const std::string beginning = event.text.substr(0, BeginningLength);
    const TimePoint now = clock_.now();
    {
        const std::scoped_lock lock(mutex_);
        if (recent_.size() >= MaxBeginnings && !recent_.contains(beginning)) recent_.clear();
        // In this order: a flood of one kind leaves room for others.
        if (!passes(recent_[beginning], PerSecond, beginning, event, now) ||
            !passes(all_, AllPerSecond, "", event, now))
            return;
    }
    sink_(escaped(event));
}

void EventLimiter::tick() {
    const TimePoint now = clock_.now();
    const std::scoped_lock lock(mutex_);
    if (all_.left_out > 0 && now - all_.since >= std::chrono::seconds(1)) {
        report("", all_);
        all_ = {};
    }
    std::erase_if(recent_, [&](const auto& entry) {
        if (now - entry.second.since < std::chrono::seconds(1)) return false;
        if (entry.second.left_out > 0) report(entry.first, entry.second);
        return true;
    });
}

void EventLimiter::report(const std::string& beginning, const Recent& recent) {
    const std::string alike = beginning.empty() ? "" : " like '" + escaped(beginning) + "...'";
    sink_({recent.severity, std::to_string(recent.left_out) + " more messages" + alike + " were left out"});
}

}  // namespace tessera::master
