#include "mediator/frame/pixel_set.h"

#include <utility>

namespace tessera::frame {

namespace {

constexpr std::size_t byte_count(std::size_t pixels) {
    return (pixels + 7) / 8;
}

}  // namespace

PixelSet::PixelSet(std::vector<std::uint32_t> indices, std::size_t pixel_count) {
    if (indices.size() == pixel_count) return;
    indices_ = std::make_shared<const std::vector<std::uint32_t>>(std::move(indices));
}

std::optional<PixelSet> PixelSet::from_bits(std::string_view bits, std::size_t pixel_count) {
    if (bits.empty()) return PixelSet{};
    if (bits.size() != byte_count(pixel_count)) return std::nullopt;
    std::vector<std::uint32_t> indices;
    for (std::size_t i = 0; i < 8 * bits.size(); ++i) {
        if ((static_cast<std::uint8_t>(bits[i / 8]) >> (i % 8) & 1) == 0) continue;
        if (i >= pixel_count) return std::nullopt;
        indices.push_back(static_cast<std::uint32_t>(i));
    }
    if (indices.empty() || indices.size() == pixel_count) return std::nullopt;
    return PixelSet(std::move(indices), pixel_count);
}

std::span<const std::uint32_t> PixelSet::indices() const {
    return is_all() ? std::span<const std::uint32_t>{} : std::span<const std::uint32_t>(*indices_);
}

std::string PixelSet::bits(std::size_t pixel_count) const {
    if (is_all()) return {};
    std::string bits(byte_count(pixel_count), '\0');
    for (const std::uint32_t index : *indices_)
        bits[index / 8] = static_cast<char>(static_cast<std::uint8_t>(bits[index / 8]) | 1u << (index % 8));
    return bits;
}

}  // namespace tessera::frame
