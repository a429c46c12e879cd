#pragma once

#include <string>

#include "mediator/session/view_request.h"
#include "mediator/view/view.h"

namespace tessera::master {

// Bytes of the statistics of all pixels of a view with the channels that its filter needs.
inline std::uint64_t film_bytes(const view::View& completed) {
    return 4 * (1 + std::uint64_t{completed.channels.plane_count()}) * completed.window.pixel_count();
}

// Checks sizes, camera, crop window, channels and counts. Empty = valid.
std::string problem_of(const session::ViewRequest& request);
std::string problem_of(const view::DisplayTransform& transform);

// Why this machine cannot run the view's filter, with the remedy; "" if it can. Part of problem_of().
std::string why_unavailable(const view::View& view);

// Whether pixels can need different numbers of samples, and whether the film says so: what is drawn for navigation has no noise
// to speak of.
bool has_noise(const view::View& completed);

// Adds what the view's filter needs: channels, and the path class where the filter is made for one.
void complete(view::View& view);
// The same, and what its stop rule needs.
void complete(session::ViewRequest& request);

// What the time from the film to the encoded picture depends on (time_budget.h).
std::string cost_key(const session::ViewRequest& request);

// For a picture that is rendered at half or a quarter of its size: the view of the full-size features, with one
// sample per pixel, and the scaled view itself.
view::View feature_view(const view::View& view);
view::View scaled_view(const view::View& view, std::uint32_t scale);

// The edge of the tiles: `asked` if not 0, else 128 for the renderer Raster, 64 for large pictures and 32
// for small ones; never so large that the film of one tile exceeds a bulk message.
std::uint32_t choose_tile_edge(const view::View& view, std::uint32_t asked);

}  // namespace tessera::master
