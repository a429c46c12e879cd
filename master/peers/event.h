#pragma once

#include <functional>
#include <string>

#include "mediator/base/log_subject.h"
#include "mediator/wire/messages.h"

namespace tessera::master {

// An event for the log.
struct Event {
    wire::Severity severity = wire::Severity::Info;
    std::string text;
    LogSubject about{};
    bool is_detail = false;  // a step in the life of a unit: for --log-level debug
};
using EventSink = std::function<void(const Event&)>;

}  // namespace tessera::master
