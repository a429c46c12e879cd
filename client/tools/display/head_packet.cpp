#include "client/tools/display/head_packet.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

namespace tessera::tools {

namespace {

constexpr std::size_t WithoutTurn = 3, WithTurn = 7;

// Removes and returns the first word of the text; "" when there is none.
std::string_view next_word(std::string_view& text) {
    const std::size_t begin = std::min(text.find_first_not_of(" \t"), text.size());
    text.remove_prefix(begin);
    const std::string_view word = text.substr(0, std::min(text.find_first_of(" \t"), text.size()));
    text.remove_prefix(word.size());
    return word;
}

Expected<double> parse_number(std::string_view word) {
    if (word.starts_with('+') && !word.starts_with("+-")) word.remove_prefix(1);  // written by some trackers
    double value = 0.0;
    const char* const end = word.data() + word.size();
    const auto [stop, error] = std::from_chars(word.data(), end, value);
    if (error != std::errc() || stop != end)
        return failure(ErrorCode::InvalidInput, "a word is not a number: write x y z or x y z qw qx qy qz");
    if (!std::isfinite(value))
        return failure(ErrorCode::InvalidInput,
                       "a number is not finite: send nothing while the head is lost");
    return value;
}

// Scaled by the largest component first, so that squares neither overflow nor underflow.
Expected<glm::dquat> unit(std::array<double, 4> turn) {
    double largest = 0.0;
    for (const double part : turn) largest = std::max(largest, std::abs(part));
    if (largest == 0.0)
        return failure(ErrorCode::InvalidInput, "the quaternion is zero: leave it out, or send a rotation");
    for (double& part : turn) part /= largest;
    return glm::normalize(glm::dquat(turn[0], turn[1], turn[2], turn[3]));
}

}  // namespace

Expected<display::Head> parse_head(std::string_view packet) {
    if (packet.size() > MaxHeadPacket)
        return failure(ErrorCode::InvalidInput, "the packet is longer than 512 bytes: send one line");
    if (packet.ends_with('\n')) packet.remove_suffix(1);
    if (packet.ends_with('\r')) packet.remove_suffix(1);
    std::array<double, WithTurn> values{};
    std::size_t count = 0;
    std::string_view word = next_word(packet);
    if (word == "head") word = next_word(packet);
    for (; !word.empty(); word = next_word(packet)) {
        const auto value = parse_number(word);
        if (!value) return tl::unexpected(value.error());
        if (count == values.size())
            return failure(ErrorCode::InvalidInput, "more than 7 numbers: send one head");
        values[count++] = *value;
    }
    if (count != WithoutTurn && count != WithTurn)
        return failure(ErrorCode::InvalidInput, "neither 3 nor 7 numbers: write x y z or x y z qw qx qy qz");
    display::Head head{.position = {values[0], values[1], values[2]}};
    if (count == WithTurn) {
        const auto turn = unit({values[3], values[4], values[5], values[6]});
        if (!turn) return tl::unexpected(turn.error());
        head.orientation = *turn;
    }
    return head;
}

}  // namespace tessera::tools
