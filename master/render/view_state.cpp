#include "master/render/view_state.h"

#include <algorithm>

#include "master/filter/catalog.h"
#include "mediator/filter/choice.h"

namespace tessera::master {

namespace {
constexpr std::int32_t LeastEdge = 16;  // of a coarse picture

std::uint64_t seed_of_film(const ViewState& state) {
    const view::View& view = state.request.view;
    const auto choice = filter::parse_choice(view.filter, filter::catalog());
    const bool keeps_history = choice && choice->entry->description.temporal;
    return view.seed + (keeps_history && state.shows_all() && state.films > 0 ? state.films - 1 : 0);
}
}  // namespace

bool has_coarse_pass(const view::View& view, std::uint32_t scale) {
    return std::min(view.window.width, view.window.height) >= LeastEdge * static_cast<std::int32_t>(scale);
}

std::vector<Pass> passes_of(const ViewState& state, std::uint32_t coarsest) {
    const view::View& whole = state.request.view;
    std::vector<Pass> passes;
    for (const std::uint32_t scale : {8u, 4u, 2u}) {
        if (!state.shows_all() || scale > coarsest || !has_coarse_pass(whole, scale)) continue;
        Pass pass{.view = scaled_view(whole, scale), .kind = Pass::Kind::Coarse, .scale = scale};
        pass.view.channels = whole.channels;
        passes.push_back(std::move(pass));
    }
    const bool upsampled = state.run.scale > 1;
    if (upsampled) passes.push_back({.view = feature_view(whole), .kind = Pass::Kind::Features});
    passes.push_back(
        {.view = upsampled ? scaled_view(whole, state.run.scale) : whole, .spp = state.request.stop.spp});
    const std::uint64_t seed = seed_of_film(state);
    for (std::size_t i = 0; i < passes.size(); ++i) {
        passes[i].view.id = ViewId{state.id.value + i};
        passes[i].view.revision = state.revision;
        passes[i].view.seed = seed;
    }
    return passes;
}

}  // namespace tessera::master
