#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace tessera::frame {

// Which pixels of a tile have samples, as indices in raster order. Shared and immutable. Canonical: a set of all pixels
// is is_all(), so that equal sets compare equal.
class PixelSet {
  public:
    PixelSet() = default;  // all pixels
    // The indices ascend and are below `pixel_count`, the number of pixels of the tile; there is at least one.
    PixelSet(std::vector<std::uint32_t> indices, std::size_t pixel_count);
    // From one bit a pixel, the lowest of each byte first. No bytes: all pixels. Nothing: another size than the tile's, a
    // bit beyond its end, no pixel at all, or each of them, which has no bytes.
    static std::optional<PixelSet> from_bits(std::string_view bits, std::size_t pixel_count);

    bool is_all() const { return indices_ == nullptr; }
    std::size_t count(std::size_t pixel_count) const { return is_all() ? pixel_count : indices_->size(); }
    // Of the i-th pixel of the set.
    std::uint32_t index(std::size_t i) const {
        return is_all() ? static_cast<std::uint32_t>(i) : (*indices_)[i];
    }
    std::span<const std::uint32_t> indices() const;   // not of all pixels
    std::string bits(std::size_t pixel_count) const;  // empty: all pixels

    friend bool operator==(const PixelSet& a, const PixelSet& b) {
        return a.indices_ == b.indices_ || (a.indices_ && b.indices_ && *a.indices_ == *b.indices_);
    }

  private:
    std::shared_ptr<const std::vector<std::uint32_t>> indices_;  // ascending; null: all
};

}  // namespace tessera::frame
