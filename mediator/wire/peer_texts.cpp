#include "mediator/wire/peer_texts.h"

#include <string>
#include <type_traits>
#include <variant>

namespace tessera::wire {

namespace {

void shorten(std::string& text) {
    if (text.size() > MaxTextBytes) text.resize(MaxTextBytes);
}

}  // namespace

void shorten_texts(ControlMessage& message) {
    std::visit(
        []<class M>(M& each) {
            if constexpr (std::is_same_v<M, UnitReleased>) shorten(each.message);
            if constexpr (std::is_same_v<M, Notice>) shorten(each.text);
            if constexpr (std::is_same_v<M, Resync> || std::is_same_v<M, SceneRefused> ||
                          std::is_same_v<M, Goodbye>)
                shorten(each.reason);
        },
        message);
}

}  // namespace tessera::wire
