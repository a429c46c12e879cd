#include "client/tools/progress_line.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "client/tools/formatted.h"

namespace tessera::tools {

namespace {

std::string time_left(double left) {
    const auto whole = static_cast<unsigned long>(std::ceil(left));
    if (whole < 100) return formatted("%lu s left", whole);
    if (whole < 6000) return formatted("%lu:%02lu min left", whole / 60, whole % 60);
    return formatted("%lu:%02lu h left", whole / 3600, whole / 60 % 60);
}

}  // namespace

std::string describe(const session::ViewProgress& progress, const session::ViewRequest& request) {
    switch (progress.phase) {
        case session::Phase::WaitingForNodes:
            return formatted("waiting for nodes: %u of %u", progress.nodes, request.min_nodes);
        case session::Phase::Syncing:
            return formatted("sending the scene to the nodes: %u ready", progress.nodes);
        case session::Phase::Filtering:
            return "filtering";
        case session::Phase::Delivering:
            return "fetching the picture";
        case session::Phase::Rendering:
            break;
    }
    const bool by_time = request.stop.time_limit > Duration::zero() && !request.stop.has_goal();
    const double elapsed = std::max(seconds(progress.elapsed), 1e-3);
    const double expected = double(std::max<std::uint64_t>(progress.samples_expected, 1));
    // The rest of the samples, after those of a film that is continued.
    const double before = double(progress.samples_before);
    const double by_samples = (double(progress.samples) - before) / std::max(expected - before, 1.0);
    const double done = std::min(1.0, !by_time ? by_samples
                                      : request.stop.has_steps()
                                          ? elapsed / seconds(request.stop.time_limit)
                                          : std::max(elapsed / seconds(request.stop.time_limit), by_samples));
    const double spp =
        double(progress.samples) / double(std::max<std::size_t>(request.view.window.pixel_count(), 1));
    std::string text = formatted("%3.0f %%   ", 100.0 * done);
    if (request.stop.has_steps()) {
        text += formatted("%.1f spp", spp);
        const bool has_error = request.stop.error > 0.0;
        const double so_far = has_error ? progress.error : progress.noise;
        const double wanted = has_error ? request.stop.error : request.stop.noise;
        if (so_far > 0.0) text += formatted("   %s %.3g", has_error ? "error" : "noise", so_far);
        if (so_far > 0.0 && wanted > 0.0) text += formatted(" of %.3g", wanted);
    } else {
        text += by_time
                    ? formatted("%.1f spp", spp)
                    : formatted("%.0f of %llu spp", spp, static_cast<unsigned long long>(request.stop.spp));
    }
    text += formatted("   %.1f Mrays/s   %u node%s", double(progress.rays) / elapsed * 1e-6, progress.nodes,
                      progress.nodes == 1 ? "" : "s");
    if (done > 0.0) text += "   " + time_left(elapsed * (1.0 - done) / done);
    return text;
}

ProgressLine::ProgressLine() : is_terminal_(::isatty(STDERR_FILENO) == 1) {}

ProgressLine::~ProgressLine() {
    if (is_shown_) std::fputs("\r\033[K", stderr);
}

void ProgressLine::show(const std::string& text) {
    if (!is_terminal_) return;
    is_shown_ = true;
    std::fprintf(stderr, "\r\033[K%s", text.c_str());
    std::fflush(stderr);
}

}  // namespace tessera::tools
