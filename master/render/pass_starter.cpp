#include "master/render/pass_starter.h"

namespace tessera::master {

void PassStarter::begin(Pass& pass, const PlanSettings& plan, const NodeRequirements& requirements,
                        std::optional<TimePoint> deadline, std::vector<frame::FilmTile>&& blocks) {
    Scheduler& scheduler = dispatcher.begin(pass.view, plan, requirements, deadline);
    pass.tiles = static_cast<std::uint32_t>(scheduler.tiles().size());
    FrameAssembler assembler(scheduler.tiles(), pass.view.channels, plan.spp);
    for (frame::FilmTile& block : blocks) {
        const frame::SampleBlock samples = block.block;
        const FrameAssembler::Result result = assembler.insert(std::move(block), {});
        if (result.outcome == FrameAssembler::Outcome::Merged) scheduler.restored(result.tile, samples);
    }
    film.open(pass.view.id, pass.view.revision, std::move(assembler));
}

void PassStarter::end(ViewId pass) {
    if (dispatcher.find(pass) == nullptr) return;
    dispatcher.end(pass);
    film.close(pass);
}

void PassStarter::end_all(ViewState& view) {
    for (const Pass& pass : view.passes) end(pass.view.id);
    view.passes.clear();
    view.current = 0;
    view.shown.reset();
}

}  // namespace tessera::master
