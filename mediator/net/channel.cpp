#include "mediator/net/channel.h"

#include <array>

namespace tessera::net {

const char* name(Role role) {
    static constexpr std::array Names{"none", "viewer", "editor", "node", "operator"};
    return Names[static_cast<std::size_t>(role)];
}

}  // namespace tessera::net
