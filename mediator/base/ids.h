#pragma once

#include <compare>
#include <cstdint>
#include <string_view>  // std::hash, at half of what <functional> costs
#include <tuple>

namespace tessera {

// A typed id: ids of different kinds cannot be mixed up. 0 is invalid.
template <class Tag>
struct Id {
    std::uint64_t value = 0;

    constexpr explicit operator bool() const { return value != 0; }
    friend constexpr auto operator<=>(Id, Id) = default;
};

using ObjectId = Id<struct ObjectTag>;  // below 2^32, so that it fits a film plane
using ViewId = Id<struct ViewTag>;
using UnitId = Id<struct UnitTag>;
using NodeId = Id<struct NodeTag>;
using SessionId = Id<struct SessionTag>;

// The scene's version: every start of a master has a new epoch, the number grows by one per change list.
struct Version {
    std::uint64_t epoch = 0;
    std::uint64_t number = 0;

    friend constexpr auto operator<=>(const Version&, const Version&) = default;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "epoch", &Version::epoch), row(2, "number", &Version::number));
    }
};

}  // namespace tessera

template <class Tag>
struct std::hash<tessera::Id<Tag>> {
    std::size_t operator()(tessera::Id<Tag> id) const noexcept {
        return std::hash<std::uint64_t>{}(id.value);
    }
};
