#pragma once

#include <string>

#include "master/render/stop_rule.h"
#include "mediator/view/view.h"
#include "mediator/wire/messages.h"

namespace tessera::master {

// What a client asks to have rendered: what is seen, until when, by whom, and what of it is delivered.
struct ViewRequest {
    std::string name;  // for others; "" = the master's choice
    view::View view;   // id and revision are the master's to choose
    StopRule stop;
    wire::Policy policy = wire::Policy::Mixed;
    bool reproducible = false;    // only nodes pinned to AVX2
    std::uint32_t tile = 0;       // edge in pixels; 0 = the master's choice
    std::uint32_t min_nodes = 0;  // begin when so many are ready
    Duration wait_limit{0};       // give up after so long without nodes; 0 = never

    // Every picture that is newer, coarse ones first; or the last alone, for an owner who waits for it.
    enum class Frames : std::uint8_t { All, Last };
    Frames frames = Frames::All;
    wire::PictureEncoding picture = wire::PictureEncoding::None;
    bool film = false;  // the statistics, too
};

// Sizes, finite camera, window inside the picture, channels, counts. Empty = fine.
std::string problem_of(const ViewRequest& request);

// Adds what the view's filter needs: channels, and the path class where the filter is made for one.
void complete(view::View& view);

// What the time from the film to the encoded picture depends on (time_budget.h).
std::string way_of(const ViewRequest& request);

// For a picture that is rendered at half or a quarter of the size: the features of the full size, one sample
// each; and the small view itself.
view::View feature_view(const view::View& view);
view::View scaled_view(const view::View& view, std::uint32_t scale);

// The edge of the tiles: what was asked for, else 128 for the renderer Raster, 64 for large pictures and 32
// for small ones; never so large that the film of one tile exceeds a bulk message.
std::uint32_t choose_tile_edge(const view::View& view, std::uint32_t asked);

}  // namespace tessera::master
