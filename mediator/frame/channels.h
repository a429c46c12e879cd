#pragma once

#include <array>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <span>
#include <string_view>

namespace tessera::frame {

// How values of one pixel become one. Planes are what a channel of c components keeps in a film tile:
//   Moments  2c planes: means, then M2 = sum of squared deviations   (variance = M2 / (n - 1))
//   Sum      c planes: the plain sum                                  (resolve divides by n)
//   Minimum, Maximum  c planes; empty pixels hold +inf, -inf
//   Nearest  c planes, the first is the key: the record with the smaller key stays, ties to the lower sample
//   First    c planes: the record of the lowest sample index stays
enum class MergeRule : std::uint8_t { Moments, Sum, Minimum, Maximum, Nearest, First };

// Values are on the wire: never renumber.
enum class Channel : std::uint8_t {
    Radiance = 0,      // all light that reaches the pixel
    LowVariance = 1,   // paths outside the view's path class (Schwenk 3.3)
    HighVariance = 2,  // paths of the view's path class; Radiance = LowVariance + HighVariance per sample
    Albedo = 3,        // of the first non-delta hit times the weight of the way to it; misses count 0
    Normal = 4,        // mapped shading normal of the first non-delta hit, world; misses count 0
    Depth = 5,  // distance of the first hit along the view direction's axis (z), nearest sample; miss = +inf
    ObjectIndex =
        6,      // key = depth, value = scene object id of the nearest first hit (bits of a uint32), 0 = miss
    Alpha = 7,  // 1 where the camera's ray hits something, 0 where it leaves the scene
    Range = 8,  // head light and ambient at the first non-delta hits, in [0, 1] (Schwenk 3.3.3)
    ShadingFeature = 9,  // light found by the path, in grey, without the surface's colour (Lardinoije 4.2)
    Irradiance = 10,     // light of the diffuse lobe at the first non-delta hit: times albedo = its radiance
    EvenHalf = 11,       // r, g, b of the samples of even index, and 1 for each of them
    Color = 12,  // all light that reaches the pixel, without second moments: half of Radiance's planes, for
                 // who only wants the picture
};
inline constexpr std::size_t ChannelCount = 13;

struct ChannelInfo {
    Channel channel;
    std::string_view name;  // EXR layer and option name
    MergeRule rule;
    std::uint32_t components;
    std::uint32_t plane_count() const { return rule == MergeRule::Moments ? 2 * components : components; }
};

std::span<const ChannelInfo, ChannelCount> channel_table();
const ChannelInfo& info(Channel channel);
std::optional<Channel> channel_by_name(std::string_view name);

class ChannelSet {
  public:
    constexpr ChannelSet() = default;
    constexpr ChannelSet(std::initializer_list<Channel> channels) {
        for (const Channel channel : channels) insert(channel);
    }
    static constexpr ChannelSet from_bits(std::uint32_t bits) {
        ChannelSet set;
        set.bits_ = bits & ((1u << ChannelCount) - 1u);
        return set;
    }
    constexpr std::uint32_t bits() const { return bits_; }
    constexpr bool contains(Channel channel) const { return (bits_ >> static_cast<unsigned>(channel)) & 1u; }
    constexpr void insert(Channel channel) { bits_ |= 1u << static_cast<unsigned>(channel); }
    constexpr void erase(Channel channel) { bits_ &= ~(1u << static_cast<unsigned>(channel)); }
    constexpr bool empty() const { return bits_ == 0; }
    std::uint32_t plane_count() const;                 // over all channels in the set
    std::uint32_t first_plane(Channel channel) const;  // planes are in the order of the enum
    friend constexpr bool operator==(ChannelSet, ChannelSet) = default;

  private:
    std::uint32_t bits_ = 0;
};

}  // namespace tessera::frame
