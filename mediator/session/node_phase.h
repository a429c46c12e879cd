#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace tessera::session {

// What a node is doing.
enum class NodePhase : std::uint8_t { Idle, Syncing, Building, Rendering, Leaving };
constexpr auto enumerators(NodePhase) {
    return std::to_array<std::string_view>({"idle", "syncing", "building", "rendering", "leaving"});
}

}  // namespace tessera::session
