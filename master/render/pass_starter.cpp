#include "master/render/pass_starter.h"

#include <algorithm>
#include <bit>

#include "master/render/adaptive/saved_step.h"

namespace tessera::master {

namespace {

// Returns what is left of the step.
std::vector<Round> continue_step(Scheduler& scheduler, const FrameAssembler& film,
                                 std::span<const wire::SavedPart> step) {
    const auto base = static_cast<std::uint8_t>(std::countr_zero(session::StopRule::AdaptiveBase));
    std::uint64_t further = 0;
    for (std::uint32_t tile = 0; tile < film.tile_count(); ++tile) {
        const std::vector<std::uint8_t> doublings = film.doublings(tile);
        const auto has_base = [&](std::uint8_t n) { return n >= base && n < 32; };
        if (doublings.empty() || !std::ranges::all_of(doublings, has_base)) {
            scheduler.give_up(
                {tile, {0, base}, "no node could render it in the film that this one continues"});
            continue;
        }
        scheduler.restored(tile, {0, base});
        for (const std::uint8_t n : doublings)
            further += (std::uint64_t{1} << n) - session::StopRule::AdaptiveBase;
    }
    scheduler.restored_more(further);
    std::vector<Round> rounds = remaining_rounds(step, film);
    if (!rounds.empty()) scheduler.begin_step(std::vector<Round>(rounds));
    return rounds;
}

}  // namespace

void PassStarter::begin(Pass& pass, const PlanSettings& plan, const NodeRequirements& requirements,
                        std::optional<TimePoint> deadline, EarlierFilm&& earlier) {
    Scheduler& scheduler = dispatcher.begin(pass.view, plan, requirements, deadline);
    pass.tiles = static_cast<std::uint32_t>(scheduler.tiles().size());
    const std::uint64_t most = plan.is_adaptive ? session::MaxSamplesPerPixel : plan.spp;
    FrameAssembler assembler(scheduler.tiles(), pass.view.channels, most);
    for (frame::FilmTile& block : earlier.blocks) {
        // Before the first step all pixels have the same samples: a damaged folder may say otherwise.
        if (earlier.steps == 0 && !block.pixels.is_all()) continue;
        const frame::SampleBlock samples = block.block;
        const FrameAssembler::Result result = assembler.insert(std::move(block), {});
        if (result.outcome == FrameAssembler::Outcome::Merged && earlier.steps == 0)
            scheduler.restored(result.tile, samples);
    }
    std::vector<Round> step;
    if (plan.is_adaptive && earlier.steps > 0) step = continue_step(scheduler, assembler, earlier.step);
    film.open(pass.view.id, pass.view.revision, std::move(assembler), std::move(step));
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
