#pragma once

#include <memory>
#include <string>

#include "client/session.h"

namespace tessera::tools {

// A member of the live scene that has a display in front of it.
struct DisplayMember {
    std::string display;  // its name
    std::unique_ptr<client::Session> session;
};

// `name`: of the member, for others. Throws Error{Refused} when no display is open, and starts no scene then.
DisplayMember join_display(const client::Address& address, const std::string& name, const Clock& clock);

}  // namespace tessera::tools
