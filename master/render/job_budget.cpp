// Pictures within a time budget: when sampling must stop, and how large a picture can be.
#include <algorithm>

#include "master/render/job_runner.h"

namespace tessera::master {

// True when it is known how long filter and encoding will take; before, the merger tries them out.
bool JobRunner::budget_is_planned(TimePoint now) {
    const wire::StartJob& request = job_->request;
    if (request.budget == Duration::zero()) return true;
    if (!job_->budget_since) job_->budget_since = now;
    const auto predicted = time_budget_.predict(job_->way, request.view.window.pixel_count());
    if (!predicted) {
        if (!job_->rehearsing) merger_.rehearse(request.job, request.view, request.picture);
        job_->rehearsing = true;
        job_->phase = wire::JobPhase::Syncing;
        return false;
    }
    job_->predicted_seconds = *predicted;
    const auto after = std::chrono::duration_cast<Duration>(std::chrono::duration<double>(*predicted));
    job_->deadline = std::max(now, *job_->budget_since + request.budget - after);
    return true;
}

// With a budget every pixel shall have its first samples; for that it may be late by a part of the budget.
bool JobRunner::time_is_up(TimePoint now) const {
    if (!job_->deadline || now < *job_->deadline) return false;
    if (job_->request.budget == Duration::zero() || job_->scheduler->tiles_without_samples() == 0)
        return true;
    constexpr int PartOfBudget = 8;
    return now >= *job_->deadline + job_->request.budget / PartOfBudget;
}

// A budget too small for two samples in every pixel: fewer pixels, and features to bring them back to size.
void JobRunner::choose_scale(TimePoint now) {
    wire::StartJob& request = job_->request;
    if (!request.adapts_size || !job_->deadline) return;
    double rate = 0.0;
    for (const auto& [id, node] : nodes_.all()) {
        if (ready(node)) rate += node.capacity().workers * balancer_.rate(id);
    }
    constexpr double LeastSamples = 2.5;  // 2, and room for what is lost at the end of the time
    job_->scale = scale_that_fits(request.view.window.pixel_count(), seconds(*job_->deadline - now), rate,
                                  LeastSamples);
    if (job_->scale == 1) return;
    job_->stage = feature_view(request.view);
    job_->full_pixels = request.view.window.pixel_count();
    const ViewId id = job_->stage->id;
    request.view = scaled_view(request.view, job_->scale);
    request.view.id = ViewId{next_view_++};
    job_->stage->id = id;
    job_->stage_deadline = now + (*job_->deadline - now) / 2;  // pixels without features are blurred, no more
}

}  // namespace tessera::master
