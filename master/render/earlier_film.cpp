#include "master/render/earlier_film.h"

#include "master/render/filter_change.h"
#include "master/render/view_request.h"

namespace tessera::master {

namespace {

std::string channel_problem(const frame::ChannelSet& film, const frame::ChannelSet& view) {
    const frame::ChannelSet missing = view - film;
    if (!missing.empty())
        return "its film lacks the channels " + channel_names(missing) +
               ", which the picture or its filter needs: leave "
               "out what needs them, or render it anew";
    return film == view ? "" : "its film has channels that the view does not ask for";
}

}  // namespace

std::string problem_of(const frame::FilmState& film, const session::ViewRequest& completed) {
    const Rect& window = completed.view.window;
    const auto edge = static_cast<std::int32_t>(choose_tile_edge(completed.view, completed.tile));
    if (film.steps > 0 && !completed.has_steps())
        return "pixels of its film have different numbers of samples: let it go on to a noise or for a time, "
               "with steps";
    const std::uint64_t most = completed.has_steps() ? session::MaxSamplesPerPixel : completed.stop.spp;
    for (const frame::FilmTile& block : film.blocks) {
        if (std::string problem = channel_problem(block.channels, completed.view.channels); !problem.empty())
            return problem;
        const Rect& rect = block.rect;
        const Rect tile = intersection({rect.x, rect.y, edge, edge}, window);
        if (rect != tile || (rect.x - window.x) % edge != 0 || (rect.y - window.y) % edge != 0)
            return "its film has other tiles than the view: ask for the same window and tile size";
        if (block.block.end() > most)
            return "its film has more samples per pixel than the " + std::to_string(most) +
                   " that are asked for: ask for more";
    }
    return {};
}

}  // namespace tessera::master
