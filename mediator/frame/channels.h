#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <span>
#include <string_view>

namespace tessera::frame {

// How the samples of a pixel are merged, and the planes of a film tile for a channel of c components:
//   Moments  2c planes: means, then M2 = sum of squared deviations   (variance = M2 / (n - 1))
//   Sum      c planes: the plain sum                                  (resolve divides by n)
//   Minimum, Maximum  c planes; empty pixels hold +inf, -inf
//   Nearest  c planes, the first is the key: the record with the smaller key stays, ties to the lower sample
//   First    c planes: the record of the lowest sample index stays
// Two rules follow from the means of radiance when blocks are merged; samples have no values for them (merge.h):
//   BlockVariance  2 planes: squared half difference of the two halves of the block, and the mean of those of the halves
//   FirstHalf      4 planes: mean of the first half of the block, and its number of samples
enum class MergeRule : std::uint8_t {
    Moments,
    Sum,
    Minimum,
    Maximum,
    Nearest,
    First,
    BlockVariance,
    FirstHalf
};
constexpr auto enumerators(MergeRule) {
    return std::to_array<std::string_view>(
        {"moments", "sum", "minimum", "maximum", "nearest", "first", "block_variance", "first_half"});
}

// Values are on the wire: never renumber.
enum class Channel : std::uint8_t {
    Radiance = 0,
    LowVariance = 1,
    HighVariance = 2,
    Albedo = 3,
    Normal = 4,
    Depth = 5,
    ObjectIndex = 6,
    Alpha = 7,
    Headlight = 8,
    ShadingFeature = 9,
    Irradiance = 10,
    HalfBufferA = 11,
    Color = 12,
    BlockVariance = 13,
    FirstHalf = 14,
    Root = 15,
};

struct ChannelInfo {
    Channel channel;
    std::string_view name;  // EXR layer and option name
    MergeRule rule;
    std::uint32_t components;
    std::string_view meaning;  // for users
    constexpr std::uint32_t plane_count() const {
        return rule == MergeRule::Moments ? 2 * components : components;
    }
    constexpr bool is_derived() const {
        return rule == MergeRule::BlockVariance || rule == MergeRule::FirstHalf;
    }
    // Values of one sample.
    constexpr std::uint32_t value_count() const { return is_derived() ? 0 : components; }
};

// One row per channel, in the order of their numbers, without gaps.
inline constexpr auto ChannelTable = std::to_array<ChannelInfo>({
    {Channel::Radiance, "radiance", MergeRule::Moments, 3, "radiance of the pixel"},
    {Channel::LowVariance, "low_variance", MergeRule::Moments, 3,
     "radiance of paths outside the view's path class (Schwenk 3.3)"},
    {Channel::HighVariance, "high_variance", MergeRule::Moments, 3,
     "radiance of paths of the view's path class: radiance minus low_variance, per sample"},
    {Channel::Albedo, "albedo", MergeRule::Sum, 3,
     "of the first non-delta hit times the throughput of the path to it; misses count 0"},
    {Channel::Normal, "normal", MergeRule::Sum, 3,
     "mapped shading normal of the first non-delta hit, world; misses count 0"},
    {Channel::Depth, "depth", MergeRule::Minimum, 1,
     "distance of the first hit along the view direction's axis (z), nearest sample; miss = +inf"},
    {Channel::ObjectIndex, "object_id", MergeRule::Nearest, 2,
     "depth, then the scene object id of the nearest first hit (bits of a uint32), 0 = miss"},
    {Channel::Alpha, "alpha", MergeRule::Sum, 1,
     "1 where the camera ray hits a surface, 0 where it leaves the scene"},
    {Channel::Headlight, "headlight", MergeRule::Sum, 3,
     "headlight and ambient at the first non-delta hits, in [0, 1] (Schwenk 3.3.3)"},
    {Channel::ShadingFeature, "shading", MergeRule::Moments, 1,
     "shading feature: grey illumination without the surface's colour (Lardinoije 4.2)"},
    {Channel::Irradiance, "irradiance", MergeRule::Moments, 3,
     "irradiance of the diffuse lobe at the first non-delta hit: times albedo = its radiance"},
    {Channel::HalfBufferA, "half_buffer_a", MergeRule::Sum, 4,
     "sum of r, g, b of the samples of even index, and their count; in old films only"},
    {Channel::Color, "color", MergeRule::Sum, 3,
     "radiance of the pixel without second moments, for pictures without statistics: half of radiance's "
     "planes"},
    {Channel::BlockVariance, "block_variance", MergeRule::BlockVariance, 2,
     "variance of the mean, by the difference between the two halves of the samples, and the same of the "
     "halves"},
    {Channel::FirstHalf, "first_half", MergeRule::FirstHalf, 4,
     "mean radiance of the first half of the samples, and their count"},
    {Channel::Root, "root", MergeRule::Moments, 3,
     "2 (sqrt(max(L, 0)) - 1) of each component L of a sample's radiance (Box-Cox transform; Sakai 2024)"},
});
inline constexpr std::size_t ChannelCount = ChannelTable.size();

static_assert([] {
    for (std::size_t i = 0; i < ChannelCount; ++i) {
        if (static_cast<std::size_t>(ChannelTable[i].channel) != i) return false;
    }
    return true;
}());

constexpr std::span<const ChannelInfo, ChannelCount> channel_table() {
    return ChannelTable;
}
constexpr const ChannelInfo& info(Channel channel) {
    return ChannelTable[static_cast<std::size_t>(channel)];
}
std::optional<Channel> channel_by_name(std::string_view name);

// Any of 128 channels. Planes of a film are in the order of their numbers.
class ChannelSet {
  public:
    using Words = std::array<std::uint64_t, 2>;  // bit i of word w: channel 64 w + i
    static constexpr std::size_t Capacity = 128;

    constexpr ChannelSet() = default;
    constexpr ChannelSet(std::initializer_list<Channel> channels) {
        for (const Channel channel : channels) insert(channel);
    }
    // All that can be rendered.
    static constexpr ChannelSet all() {
        ChannelSet set;
        for (const ChannelInfo& entry : ChannelTable) set.insert(entry.channel);
        set.erase(Channel::HalfBufferA);
        return set;
    }
    // As received: may have bits of unknown channels.
    static constexpr ChannelSet from_words(const Words& words) {
        ChannelSet set;
        set.words_ = words;
        return set;
    }
    constexpr const Words& words() const { return words_; }
    constexpr Words& words() { return words_; }
    constexpr bool is_known() const { return (*this - all() - ChannelSet{Channel::HalfBufferA}).empty(); }
    // Why no film can have these channels, or nullptr.
    constexpr const char* malformed() const {
        if (!is_known()) return "a channel is unknown";
        const bool is_derived = contains(Channel::BlockVariance) || contains(Channel::FirstHalf);
        if (is_derived && !contains(Channel::Radiance)) return "block_variance and first_half need radiance";
        return nullptr;
    }
    // Why they cannot be rendered, or nullptr.
    constexpr const char* not_renderable() const {
        if (contains(Channel::HalfBufferA)) return "half_buffer_a is no longer rendered: request first_half";
        return malformed();
    }
    // For the shading code, whose channels are all below 32.
    constexpr std::uint32_t kernel_bits() const { return static_cast<std::uint32_t>(words_[0]); }

    constexpr bool contains(Channel channel) const { return (word(channel) >> shift(channel)) & 1u; }
    constexpr bool contains(const ChannelSet& others) const { return (others - *this).empty(); }
    constexpr void insert(Channel channel) { word(channel) |= std::uint64_t{1} << shift(channel); }
    constexpr void erase(Channel channel) { word(channel) &= ~(std::uint64_t{1} << shift(channel)); }
    constexpr bool empty() const { return words_ == Words{}; }
    std::uint32_t plane_count() const;  // over all channels in the set
    std::uint32_t first_plane(Channel channel) const;

    // Visits the channels in order until `visit` returns false. Loops over the set bits only.
    template <class Visit>
    constexpr bool for_each(const Visit& visit) const {
        for (std::size_t word = 0; word < words_.size(); ++word) {
            for (std::uint64_t rest = words_[word]; rest != 0; rest &= rest - 1) {
                const std::size_t number = 64 * word + static_cast<std::size_t>(std::countr_zero(rest));
                if (!visit(ChannelTable[number])) return false;
            }
        }
        return true;
    }

    friend constexpr ChannelSet operator|(const ChannelSet& a, const ChannelSet& b) {
        return from_words({a.words_[0] | b.words_[0], a.words_[1] | b.words_[1]});
    }
    friend constexpr ChannelSet operator-(const ChannelSet& a, const ChannelSet& b) {
        return from_words({a.words_[0] & ~b.words_[0], a.words_[1] & ~b.words_[1]});
    }
    friend constexpr bool operator==(const ChannelSet&, const ChannelSet&) = default;

  private:
    static constexpr unsigned shift(Channel channel) { return static_cast<unsigned>(channel) % 64; }
    constexpr const std::uint64_t& word(Channel channel) const {
        return words_[static_cast<std::size_t>(channel) / 64];
    }
    constexpr std::uint64_t& word(Channel channel) { return words_[static_cast<std::size_t>(channel) / 64]; }

    Words words_{};
};

static_assert(ChannelCount <= ChannelSet::Capacity);

}  // namespace tessera::frame
