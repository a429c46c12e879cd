#pragma once

#include <optional>
#include <string>

#include "mediator/base/ids.h"

namespace tessera {

// What a line of a log is about: a search for one of its values finds all lines of a unit, a view, a session or a node.
struct LogSubject {
    std::string node{};  // its name
    SessionId session{};
    ViewId view{};
    UnitId unit{};
    std::optional<Version> version{};  // of the scene
};

}  // namespace tessera
