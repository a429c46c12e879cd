#include "tests/bench/filters/filter_run.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "mediator/base/clock.h"
#include "mediator/base/parallel.h"

namespace tessera::tools::bench {

namespace {

double since(TimePoint start) {
    return seconds(std::chrono::steady_clock::now() - start);
}

frame::Image colors(const filter::Planes& planes, const std::string& name) {
    frame::Image image(planes.width(), planes.height(), 3);
    for (std::uint32_t c = 0; c < 3; ++c) {
        const auto plane = planes.plane(c);
        for (std::size_t i = 0; i < plane.size(); ++i) {
            if (!std::isfinite(plane[i])) {
                throw Error(ErrorCode::Internal, "filter '" + name +
                                                     "' produced a value that is not finite at pixel " +
                                                     std::to_string(i % planes.width()) + "," +
                                                     std::to_string(i / planes.width()));
            }
            image.values[3 * i + c] = plane[i];
        }
    }
    return image;
}

}  // namespace

double copy_bandwidth(std::size_t bytes, tbb::task_arena& arena) {
    constexpr int Tries = 7;
    constexpr std::size_t Chunk = std::size_t{64} << 10;
    const std::vector<char> from(bytes, 1);
    std::vector<char> to(bytes, 0);
    double best = 0.0;
    for (int i = 0; i < Tries; ++i) {
        const auto started = std::chrono::steady_clock::now();
        parallel_for(arena, (bytes + Chunk - 1) / Chunk, [&](std::size_t chunk) {
            const std::size_t first = chunk * Chunk;
            std::memcpy(to.data() + first, from.data() + first, std::min(Chunk, bytes - first));
        });
        best = std::max(best, 2.0 * static_cast<double>(bytes) / std::max(since(started), 1e-9));
    }
    return best;
}

FilterRun::FilterRun(const filter::Choice& choice, std::uint32_t width, std::uint32_t height,
                     tbb::task_arena& arena)
    : choice_(choice), arena_(arena), filter_(choice.entry->make(width, height)) {}

frame::Image FilterRun::picture(const filter::Inputs& inputs, std::vector<std::string>* notes) {
    filter_->reset();
    const filter::Report report = filter_->run(inputs, choice_.values, output_, {arena_, {}});
    if (notes) notes->assign(report.notes.begin(), report.notes.end());
    return colors(output_.picture, to_text(choice_));
}

frame::Image FilterRun::next_picture(const filter::Inputs& inputs) {
    filter_->run(inputs, choice_.values, output_, {arena_, {}});
    return colors(output_.picture, to_text(choice_));
}

FilterTime FilterRun::time(const filter::Inputs& inputs, double copy_bytes_per_second) {
    constexpr int MostRuns = 5;
    constexpr double Enough = 0.4;  // seconds for all runs
    FilterTime best;
    double spent = 0.0;
    for (int i = 0; i < MostRuns && spent < Enough; ++i) {
        filter_->reset();
        const auto started = std::chrono::steady_clock::now();
        const filter::Report report = filter_->run(inputs, choice_.values, output_, {arena_, {}});
        const double taken = since(started);
        spent += taken;
        if (i > 0 && taken >= best.seconds) continue;
        best = {.seconds = taken};
        for (const filter::Pass& pass : report.passes) {
            best.passes.push_back({std::string(pass.name), seconds(pass.time), pass.bytes_per_pixel});
            best.bytes_per_pixel += pass.bytes_per_pixel;
        }
    }
    const double bytes = best.bytes_per_pixel * static_cast<double>(inputs.pixel_count());
    if (bytes > 0.0) best.copy_ratio = best.seconds * copy_bytes_per_second / bytes;
    return best;
}

}  // namespace tessera::tools::bench
