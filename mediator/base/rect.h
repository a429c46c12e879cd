#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <tuple>

namespace tessera {

// Half-open pixel rectangle [x, x + width) x [y, y + height); origin top left.
struct Rect {
    std::int32_t x = 0, y = 0, width = 0, height = 0;

    constexpr std::int32_t right() const { return x + width; }
    constexpr std::int32_t bottom() const { return y + height; }
    constexpr bool empty() const { return width <= 0 || height <= 0; }
    constexpr std::size_t pixel_count() const {
        return empty() ? 0 : static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    }
    constexpr bool contains(std::int32_t px, std::int32_t py) const {
        return px >= x && px < right() && py >= y && py < bottom();
    }
    // Of a received one: sums of its numbers stay within their type.
    constexpr const char* malformed() const {
        constexpr std::int32_t Limit = 1 << 24;
        for (const std::int32_t value : {x, y, width, height}) {
            if (value < -Limit || value > Limit) return "a rectangle is absurd";
        }
        return nullptr;
    }
    friend constexpr bool operator==(const Rect&, const Rect&) = default;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "x", &Rect::x), row(2, "y", &Rect::y), row(3, "width", &Rect::width),
                          row(4, "height", &Rect::height));
    }
};

constexpr Rect intersection(const Rect& a, const Rect& b) {
    const std::int32_t x = std::max(a.x, b.x), y = std::max(a.y, b.y);
    const std::int32_t right = std::min(a.right(), b.right()), bottom = std::min(a.bottom(), b.bottom());
    return {x, y, std::max(0, right - x), std::max(0, bottom - y)};
}

}  // namespace tessera
