#include "master/render/live_view.h"

#include <algorithm>

#include "master/render/job.h"

namespace tessera::master {

namespace {
constexpr std::int32_t LeastEdge = 16;  // of a coarse picture
}

bool has_coarse_pass(const view::View& view, std::uint32_t scale) {
    return std::min(view.window.width, view.window.height) >= LeastEdge * static_cast<std::int32_t>(scale);
}

std::vector<LivePass> passes_of(const LiveView& live, std::uint32_t coarsest) {
    std::vector<LivePass> passes;
    for (const std::uint32_t scale : {8u, 4u, 2u}) {
        if (scale > coarsest || !has_coarse_pass(live.view, scale)) continue;
        LivePass pass{.view = scaled_view(live.view, scale), .scale = scale};
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
