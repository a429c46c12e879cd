// Views with a time budget.
#include "master/render/view_runner.h"

namespace tessera::master {

using session::Phase;

// True when the time of filter and encoding is known; otherwise requests a calibration.
bool ViewRunner::budget_is_planned(ViewState& view, TimePoint now) {
    const session::StopRule& stop = view.request.stop;
    Run& run = view.run;
    if (!stop.has_budget()) {
        run.deadline = stop.deadline(now, now, {});
        return true;
    }
    if (!run.ready_since) run.ready_since = now;
    const auto predicted = time_budget_.predict(run.cost_key, view.request.view.window.pixel_count());
    if (!predicted) {
        view::View calibration = view.request.view;
        calibration.id = view.id;
        if (!run.calibrating) passes_.film.calibrate(calibration, view.request.picture);
        run.calibrating = true;
        run.phase = Phase::Syncing;
        return false;
    }
    run.predicted_seconds = *predicted;
    const auto after = std::chrono::duration_cast<Duration>(std::chrono::duration<double>(*predicted));
    run.deadline = stop.deadline(*run.ready_since, now, after);
    return true;
}

// If the budget is too small for two samples per pixel: renders fewer pixels, and features for upsampling.
std::uint32_t ViewRunner::scale_that_fits(const ViewState& view, TimePoint now) const {
    if (!view.request.stop.adapts_size || !view.run.deadline) return 1;
    constexpr double LeastSamples = 2.5;  // 2, and a margin for units that are cancelled at the deadline
    return master::scale_that_fits(
        view.request.view.window.pixel_count(), seconds(*view.run.deadline - now),
        passes_.dispatcher.prospects(view.request.view, requirements(view)).samples_per_second, LeastSamples);
}

}  // namespace tessera::master
