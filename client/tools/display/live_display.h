#pragma once

#include <memory>
#include <stop_token>
#include <string>

#include "client/session.h"

namespace tessera::tools {

// A member of the live scene with an open display.
struct DisplayMember {
    std::string display;  // its name
    std::unique_ptr<client::Session> session;
};

// `name`: of the member, as others see it. Throws Error{Refused} when no display is open, without starting a scene.
DisplayMember join_display(const client::Address& address, const std::string& name, const Clock& clock,
                           std::stop_token stop = {});

}  // namespace tessera::tools
