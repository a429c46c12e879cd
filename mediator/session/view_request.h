#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>

#include "mediator/base/clock.h"
#include "mediator/base/description.h"
#include "mediator/view/display_transform.h"
#include "mediator/view/view.h"

// What a client asks to have rendered of the scene it is in.
namespace tessera::session {

// What the master makes of the film: nothing, the filtered picture as float32 planes one after another, a
// file, or (of outputs of displays alone) red, green and blue of each pixel: 8-bit sRGB, or linear half
// floats.
enum class PictureEncoding : std::uint8_t { None, Planes, Png, Jpeg, Exr, Bytes, Half };
constexpr auto enumerators(PictureEncoding) {
    return std::to_array<std::string_view>({"none", "planes", "png", "jpeg", "exr", "bytes", "half"});
}

// How samples are dealt to nodes.
enum class Policy : std::uint8_t { Tiled, Cooperative, Mixed };
constexpr auto enumerators(Policy) {
    return std::to_array<std::string_view>({"tiled", "cooperative", "mixed"});
}

// Which frames of a view are delivered: every one that is newer, coarse ones first, or the last alone.
enum class Frames : std::uint8_t { All, Last };
constexpr auto enumerators(Frames) {
    return std::to_array<std::string_view>({"all", "last"});
}

inline constexpr std::uint64_t MaxSamplesPerPixel = std::uint64_t{1} << 31;  // counts are 32 bits

// When a view has enough samples. Pure.
struct StopRule {
    std::uint64_t spp = 64;
    Duration time_limit{0};  // of sampling; 0 = none
    Duration budget{0};  // not 0: the picture is there so long after the start, filter and encoding included
    bool adapts_size =
        false;  // with a budget too small for 2 samples per pixel: half or a quarter of the size

    bool has_budget() const { return budget > Duration::zero(); }
    bool has_clock() const { return has_budget() || time_limit > Duration::zero(); }
    // The samples of a pixel that are never exceeded.
    std::uint64_t most_samples() const {
        return has_budget() || (has_clock() && spp == 0) ? MaxSamplesPerPixel : spp;
    }

    // When sampling must end, given when nodes were ready and how long filter and encoding will take.
    std::optional<TimePoint> deadline(TimePoint ready, TimePoint now, Duration afterwards) const {
        if (has_budget()) return std::max(now, ready + budget - afterwards);
        if (has_clock()) return now + time_limit;
        return std::nullopt;
    }

    // Against a budget every pixel shall have its first samples; for that it may be late by a part of it.
    bool time_is_up(std::optional<TimePoint> deadline, bool every_pixel_has_samples, TimePoint now) const {
        if (!deadline || now < *deadline) return false;
        if (!has_budget() || every_pixel_has_samples) return true;
        constexpr int PartOfBudget = 8;
        return now >= *deadline + budget / PartOfBudget;
    }

    friend bool operator==(const StopRule&, const StopRule&) = default;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "spp", &StopRule::spp), row(2, "time_limit", &StopRule::time_limit),
                          row(3, "budget", &StopRule::budget), row(4, "adapts_size", &StopRule::adapts_size));
    }
};

// What is seen, until when, by which nodes, and what of it is delivered.
struct ViewRequest {
    std::string name;  // for others; "" = the master's choice
    view::View view;   // id and revision are the master's to choose
    StopRule stop;
    Policy policy = Policy::Mixed;
    bool reproducible = false;    // only nodes pinned to AVX2
    std::uint32_t tile = 0;       // edge in pixels; 0 = the master's choice
    std::uint32_t min_nodes = 0;  // begin when so many are ready
    Duration wait_limit{0};       // give up after so long without nodes; 0 = never
    Frames frames = Frames::All;
    PictureEncoding picture = PictureEncoding::None;
    bool film = false;      // the statistics, too
    bool detached = false;  // a job: it goes on, and the master keeps its picture, when the client leaves
    view::DisplayTransform display_transform;  // of a PNG or JPEG
    static constexpr auto describe(auto row) {
        using Self = ViewRequest;
        return std::tuple(
            row(1, "name", &Self::name), row(2, "view", &Self::view), row(3, "stop", &Self::stop),
            row(4, "policy", &Self::policy), row(5, "reproducible", &Self::reproducible),
            row(6, "tile", &Self::tile), row(7, "min_nodes", &Self::min_nodes),
            row(8, "wait_limit", &Self::wait_limit), row(9, "frames", &Self::frames),
            row(10, "picture", &Self::picture, UpTo{PictureEncoding::Exr}), row(11, "film", &Self::film),
            row(12, "detached", &Self::detached), row(13, "display_transform", &Self::display_transform));
    }
};

}  // namespace tessera::session
