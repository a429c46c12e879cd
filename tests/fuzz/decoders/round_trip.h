#pragma once

#include "mediator/wire/display_codec.h"
#include "mediator/wire/envelope.h"
#include "mediator/wire/film_state_codec.h"
#include "mediator/wire/journal_codec.h"
#include "tests/fuzz/decoders/decoder.h"

namespace tessera::fuzz {

// What was decoded is encoded to bytes that decode to the same.
template <class Message, class Decode>
void require_round_trip(const Message& message, const Decode& decode) {
    const std::vector<std::byte> encoded = wire::encode(message);
    const auto again = decode(encoded);
    require(again.has_value(), "a decoded message cannot be decoded again");
    require(wire::encode(*again) == encoded,
            "a decoded message changes when it is encoded and decoded again");
}

}  // namespace tessera::fuzz
