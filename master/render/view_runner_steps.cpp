// The steps of adaptive pictures.
#include <algorithm>

#include "master/render/view_runner.h"

namespace tessera::master {

namespace {

// With nothing but a clock: as many samples as the rest of the time has room for, if it has room for a decision.
void spend_time(const ViewState& view, TimePoint now, AdaptiveSettings& settings) {
    constexpr double LeastSpp = 0.25, MostDeciding = 0.1;  // of the rest
    const Run& run = view.run;
    const double left = seconds(*run.deadline - now),
                 deciding = seconds(run.deciding) / std::max(run.steps, 1u);
    // Views with a clock start over when the master does, so all other samples are of this time.
    const double rate = double(run.samples - run.samples_before) /
                        std::max(seconds(now - run.rendering_since - run.deciding), 1e-3);
    const double samples = rate * left;
    if (run.step_is_uniform || samples < LeastSpp * double(view.request.view.window.pixel_count()) ||
        deciding > MostDeciding * left) {
        settings.uniform = true;
    } else {
        settings.samples = run.samples + static_cast<std::uint64_t>(std::min(samples, 1e18));
    }
}

// All samples after those of the first decision.
std::vector<Round> uniform_rounds(std::uint64_t spp) {
    std::vector<Round> rounds;
    for (std::uint64_t first = session::StopRule::AdaptiveBase; first < spp; first *= 2) {
        for (const frame::SampleBlock& block : frame::aligned_blocks(first, std::min(2 * first, spp)))
            rounds.push_back({block, nullptr});
    }
    return rounds;
}

}  // namespace

void ViewRunner::request_step(ViewState& view, TimePoint now) {
    Run& run = view.run;
    const session::StopRule& stop = view.request.stop;
    const ViewId pass = view.pass().view.id;
    if (run.is_deciding || passes_.dispatcher.find(pass)->complete()) return;
    if (run.is_widened)
        return passes_.dispatcher.find(pass)->begin_step(run.steps++ == 0 ? uniform_rounds(stop.spp)
                                                                          : std::vector<Round>());
    run.is_deciding = true;
    run.deciding_since = now;
    std::vector<std::uint32_t> closed;
    for (const TileFailure& failure : passes_.dispatcher.find(pass)->failed_tiles())
        closed.push_back(failure.tile);
    AdaptiveSettings settings{
        .noise = stop.noise, .max_samples = stop.spp, .step = run.steps, .uniform = stop.uniform};
    if (!stop.has_goal() && run.deadline) {
        spend_time(view, now, settings);
    } else if (view.shows_all()) {
        settings = settings_of_mean(stop.spp, view.request.view.window.pixel_count(), run.steps,
                                    run.step_is_uniform);
    }
    passes_.film.decide(view.pass().view, settings, stop.error, std::move(closed));
}

void ViewRunner::take(ViewState& view, StepDecision&& decision, TimePoint now) {
    Run& run = view.run;
    if (view.passes.empty() || view.pass().view.id != decision.view ||
        view.pass().view.revision != decision.revision || !run.is_deciding)
        return;
    run.is_deciding = false;
    run.deciding += now - run.deciding_since;
    const bool has_chosen = !decision.step.rounds.empty();
    const bool may_be_uniform =
        !view.request.stop.has_goal() && !run.step_is_uniform && (run.deadline || decision.step.noise == 0.0);
    if (!has_chosen && !run.outcome && may_be_uniform) {
        // No light was found yet, or the samples that are left in the time are fewer than a pixel would get.
        run.step_is_uniform = true;
        return request_step(view, now);
    }
    run.step_is_uniform = false;
    run.noise = decision.step.noise;
    run.error = decision.step.error;
    run.samples_expected = decision.step.samples_expected;
    ++run.steps;
    if (!run.outcome) passes_.dispatcher.find(decision.view)->begin_step(std::move(decision.step.rounds));
    advance(view, now);
}

}  // namespace tessera::master
