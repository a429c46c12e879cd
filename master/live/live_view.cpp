#include "master/live/live_view.h"

#include <algorithm>

#include "master/job.h"

namespace tessera::master {

namespace {
constexpr std::int32_t LeastEdge = 16;  // of a coarse picture
}

std::vector<LivePass> passes_of(const LiveView& live) {
    std::vector<LivePass> passes;
    const Rect& window = live.view.window;
    for (const std::int32_t scale : {8, 4, 2}) {
        if (std::min(window.width, window.height) < LeastEdge * scale) continue;
        LivePass pass{.view = scaled_view(live.view, static_cast<std::uint32_t>(scale)),
                      .scale = static_cast<std::uint32_t>(scale)};
        pass.view.channels = live.view.channels;
        pass.view.filter.clear();  // most filters need more than a sample a pixel
        passes.push_back(std::move(pass));
    }
    passes.push_back({.view = live.view, .scale = 1, .spp = live.spp});
    for (std::size_t i = 0; i < passes.size(); ++i) {
        passes[i].view.id = ViewId{live.id.value + i};
        passes[i].view.revision = live.revision;
    }
    return passes;
}

}  // namespace tessera::master
