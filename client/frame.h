#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "mediator/base/hash.h"
#include "mediator/base/ids.h"
#include "mediator/frame/film_state.h"
#include "mediator/session/view_summary.h"

namespace tessera::client {

// A frame of a view, as sent by the master.
struct Frame {
    std::uint64_t view = 0, number = 0;
    Version version;
    std::uint64_t revision = 0;  // of the view: grows with every change of its camera
    std::uint32_t scale = 1;     // 8, 4, 2: a coarse picture of this part of the view's size
    std::uint32_t width = 0, height = 0, components = 0;
    session::PictureEncoding encoding = session::PictureEncoding::None;
    std::vector<std::byte> picture;  // Planes: float32, one component after another, each in raster order
    std::optional<frame::FilmTile> film;         // of the whole window; pixels without samples have count 0
    std::optional<frame::FilmState> film_state;  // of the same film, if the request asks for it
    std::uint64_t min_samples = 0, max_samples = 0, spp = 0;  // per pixel
    double mean_samples = 0.0;                                // likewise
    double noise = 0.0;  // of its samples at the last decision: sqrt(relMSE); 0: unknown
    bool complete = false;
    Hash256 film_hash;  // if complete, and if the view delivers every frame
};

// A view that its stop rule has ended.
struct ViewResult {
    session::ViewSummary summary;
    Frame frame;  // the last; empty when nothing was rendered

    bool has_picture() const { return !frame.picture.empty(); }
    const std::optional<frame::FilmTile>& film() const { return frame.film; }
};

}  // namespace tessera::client
