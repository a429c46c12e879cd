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

// What a client requests to be rendered.
namespace tessera::session {

// What the master makes of the film: nothing, the filtered picture as consecutive float32 planes, an image file, or
// (for display outputs only) interleaved RGB: 8-bit sRGB, or linear half floats.
enum class PictureEncoding : std::uint8_t { None, Planes, Png, Jpeg, Exr, Bytes, Half };
constexpr auto enumerators(PictureEncoding) {
    return std::to_array<std::string_view>({"none", "planes", "png", "jpeg", "exr", "bytes", "half"});
}

// How samples are distributed to nodes.
enum class Policy : std::uint8_t { Tiled, Cooperative, Mixed };
constexpr auto enumerators(Policy) {
    return std::to_array<std::string_view>({"tiled", "cooperative", "mixed"});
}

// Which frames of a view are delivered: every newer one, coarse ones first, or only the last.
enum class Frames : std::uint8_t { All, Last };
constexpr auto enumerators(Frames) {
    return std::to_array<std::string_view>({"all", "last"});
}

inline constexpr std::uint64_t MaxSamplesPerPixel = std::uint64_t{1} << 31;  // counts are 32 bits

// When a view has enough samples. Pure.
struct StopRule {
    std::uint64_t spp = 64;  // of any pixel
    Duration time_limit{0};  // of sampling; 0 = none
    Duration budget{0};      // not 0: time from the start to the encoded picture, filter included
    bool adapts_size =
        false;  // if the budget is too small for 2 samples per pixel: render at half or a quarter of the size
    // Not 0: until the unfiltered picture has this estimated sqrt(relMSE); spp and times are upper bounds.
    double noise = 0.0;
    // Not 0: until the picture that its filter makes has this estimated relMSE; likewise. Of noise and error, at most one.
    double error = 0.0;
    // All pixels have as many samples. Else they have what they need if noise, error or time end the picture, or if it is shown
    // while it is rendered; spp is then the mean.
    bool uniform = false;

    bool has_budget() const { return budget > Duration::zero(); }
    // What every pixel gets before the first decision: fewer say too little.
    static constexpr std::uint64_t AdaptiveBase = 16;
    // After AdaptiveBase samples there are steps, each with a decision.
    bool has_steps() const { return (has_goal() || (has_clock() && !uniform)) && spp > AdaptiveBase; }
    bool has_goal() const { return noise > 0.0 || error > 0.0; }
    bool has_clock() const { return has_budget() || time_limit > Duration::zero(); }
    // When sampling must end, given when the nodes were ready and the predicted time of filter and encoding.
    std::optional<TimePoint> deadline(TimePoint ready, TimePoint now, Duration afterwards) const {
        if (has_budget()) return std::max(now, ready + budget - afterwards);
        if (has_clock()) return now + time_limit;
        return std::nullopt;
    }

    // With a budget every pixel should have its first samples; to get them the picture may be late by a fraction of it.
    bool time_is_up(std::optional<TimePoint> deadline, bool every_pixel_has_samples, TimePoint now) const {
        if (!deadline || now < *deadline) return false;
        if (!has_budget() || every_pixel_has_samples) return true;
        constexpr int PartOfBudget = 8;
        return now >= *deadline + budget / PartOfBudget;
    }

    friend bool operator==(const StopRule&, const StopRule&) = default;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "spp", &StopRule::spp), row(2, "time_limit", &StopRule::time_limit),
                          row(3, "budget", &StopRule::budget), row(4, "adapts_size", &StopRule::adapts_size),
                          row(5, "noise", &StopRule::noise), row(6, "uniform", &StopRule::uniform),
                          row(7, "error", &StopRule::error));
    }
};

// What to render, for how long, on which nodes, and what to deliver.
struct ViewRequest {
    std::string name;  // shown to other members; "" = chosen by the master
    view::View view;   // id and revision are set by the master
    StopRule stop;
    Policy policy = Policy::Mixed;
    bool reproducible = false;    // only nodes of one kind, pinned to AVX2
    std::uint32_t tile = 0;       // edge in pixels; 0 = chosen by the master
    std::uint32_t min_nodes = 0;  // start when this many are ready
    Duration wait_limit{0};       // give up after this time without nodes; 0 = never
    Frames frames = Frames::All;
    PictureEncoding picture = PictureEncoding::None;
    bool film = false;        // also deliver the film
    bool film_state = false;  // with `film`, of views that deliver their last frame: as blocks that can go on
    bool detached = false;    // a job: continues when the client leaves, and the master stores its picture
    view::DisplayTransform display_transform;  // of a PNG or JPEG

    // After StopRule::AdaptiveBase samples there are steps, each with a decision.
    bool has_steps() const {
        const bool is_live = frames == Frames::All && !stop.uniform && stop.spp > StopRule::AdaptiveBase;
        return is_live || stop.has_steps();
    }
    static constexpr auto describe(auto row) {
        using Self = ViewRequest;
        return std::tuple(
            row(1, "name", &Self::name), row(2, "view", &Self::view), row(3, "stop", &Self::stop),
            row(4, "policy", &Self::policy), row(5, "reproducible", &Self::reproducible),
            row(6, "tile", &Self::tile), row(7, "min_nodes", &Self::min_nodes),
            row(8, "wait_limit", &Self::wait_limit), row(9, "frames", &Self::frames),
            row(10, "picture", &Self::picture, UpTo{PictureEncoding::Exr}), row(11, "film", &Self::film),
            row(12, "detached", &Self::detached), row(13, "display_transform", &Self::display_transform),
            row(14, "film_state", &Self::film_state));
    }
};

}  // namespace tessera::session
