// The steps of adaptive pictures.
#include "master/render/view_runner.h"

namespace tessera::master {

void ViewRunner::request_step(ViewState& view) {
    Run& run = view.run;
    const ViewId pass = view.pass().view.id;
    if (run.is_deciding || passes_.dispatcher.find(pass)->complete()) return;
    run.is_deciding = true;
    std::vector<std::uint32_t> closed;
    for (const TileFailure& failure : passes_.dispatcher.find(pass)->failed_tiles())
        closed.push_back(failure.tile);
    passes_.film.decide(
        pass, view.pass().view.revision,
        {.noise = view.request.stop.noise, .max_samples = view.request.stop.max_samples(), .step = run.steps},
        std::move(closed));
}

void ViewRunner::take(ViewState& view, StepDecision&& decision, TimePoint now) {
    Run& run = view.run;
    if (view.passes.empty() || view.pass().view.id != decision.view ||
        view.pass().view.revision != decision.revision || !run.is_deciding)
        return;
    run.is_deciding = false;
    run.noise = decision.step.noise;
    run.samples_expected = decision.step.samples_expected;
    ++run.steps;
    if (!run.outcome) passes_.dispatcher.find(decision.view)->begin_step(std::move(decision.step.rounds));
    advance(view, now);
}

}  // namespace tessera::master
