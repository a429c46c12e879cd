#include "mediator/net/channel.h"

#include <array>

namespace tessera::net {

const char* name(Role role) {
    static constexpr std::array Names{"none", "viewer", "editor", "node", "operator"};
    return Names[static_cast<std::size_t>(role)];
}

Role role_named(std::string_view text) {
    for (const Role role : {Role::Viewer, Role::Editor, Role::Node, Role::Operator}) {
        if (text == name(role)) return role;
    }
    return Role::None;
}

}  // namespace tessera::net
