#include "mediator/picture/mark_tiles.h"

#include <cmath>

namespace tessera::picture {

void mark_tiles(frame::Image& image, std::span<const Rect> tiles, double exposure, std::int32_t left,
                std::int32_t top) {
    constexpr std::int32_t Stripe = 4;  // pixels
    const auto bright = static_cast<float>(0.7 * std::exp2(-exposure));
    const Rect whole{left, top, static_cast<std::int32_t>(image.width),
                     static_cast<std::int32_t>(image.height)};
    for (const Rect& tile : tiles) {
        const Rect part = intersection(tile, whole);
        for (std::int32_t y = part.y; y < part.bottom(); ++y) {
            for (std::int32_t x = part.x; x < part.right(); ++x) {
                const bool is_bright = ((x + y) / Stripe) % 2 == 0;
                const auto pixel = image.pixel(static_cast<std::size_t>(y - top) * image.width +
                                               static_cast<std::size_t>(x - left));
                for (std::uint32_t c = 0; c < image.components; ++c)
                    pixel[c] = c == 3 ? 1.0f : is_bright && c != 1 ? bright : 0.0f;
            }
        }
    }
}

}  // namespace tessera::picture
