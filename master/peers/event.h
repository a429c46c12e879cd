#pragma once

#include <functional>
#include <string>

#include "mediator/wire/messages.h"

namespace tessera::master {

// An event for the log.
struct Event {
    wire::Severity severity = wire::Severity::Info;
    std::string text;
};
using EventSink = std::function<void(const Event&)>;

}  // namespace tessera::master
