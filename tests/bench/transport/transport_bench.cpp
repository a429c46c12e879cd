#include "tests/bench/transport/transport_bench.h"

#include <unistd.h>

#include <cmath>
#include <fstream>

#include "mediator/backend/catalog.h"
#include "mediator/base/clock.h"
#include "mediator/frame/resolve.h"
#include "mediator/picture/flip.h"
#include "tests/bench/filters/looks.h"
#include "tests/bench/filters/sampler.h"
#include "tests/bench/transport/cycles.h"

namespace tessera::tools::bench {

namespace {

// Of this process, now; 0 where it is not known.
double resident_bytes() {
    double all = 0.0, resident = 0.0;
    std::ifstream("/proc/self/statm") >> all >> resident;
    return resident * double(::sysconf(_SC_PAGESIZE));
}

// Standard error of the mean luminance of a picture with `samples` in all its pixels, over the references' mean: noise of
// independent samples, measured by the difference of the references, each of `reference_samples`.
double light_deviation(const ReferencePair& truth, double samples, double reference_samples) {
    constexpr std::array Weights{0.2126, 0.7152, 0.0722};
    const std::size_t pixels = truth.mean().values.size() / 3;
    double variance = 0.0;  // of one reference, summed over pixels
    for (std::size_t i = 0; i < pixels; ++i) {
        double difference = 0.0;
        for (std::size_t c = 0; c < 3; ++c)
            difference += Weights[c] * (double(truth.first().values[3 * i + c]) -
                                        double(truth.second().values[3 * i + c]));
        variance += difference * difference / 2.0;
    }
    const double mean = mean_luminance(truth.mean());
    if (!(mean > 0.0)) return 0.0;
    return std::sqrt(variance * (reference_samples / samples + 0.5)) / double(pixels) / mean;
}

void add(Estimate& sum, const Estimate& one, double seeds) {
    sum.value += one.value / seeds;
    sum.deviation += one.deviation / seeds;  // of the same references: errors add
}

std::optional<TransportCurve> measure(const std::string& backend, const BenchScene& scene,
                                      const TransportPlan& plan, const ReferencePair& truth,
                                      tbb::task_arena& arena, const BenchProgress& progress,
                                      const std::stop_token& stop) {
    TransportCurve curve{.renderer = backend, .points = {}, .samples = {}};
    const SteadyClock clock;
    const double before = resident_bytes();
    const TimePoint started = clock.now();
    const Sampler sampler(scene, arena, backend::find_backend(backend));
    const double seeds = plan.seeds;
    const double pixels = double(plan.size.width) * double(plan.size.height);
    const auto view_of = [&](std::uint32_t seed) {
        view::View view = sampler.view(plan.size.width, plan.size.height, {frame::Channel::Radiance},
                                       view::PathClass::Indirect, seed);
        view.sky_cells_from = view::visible_sky_from(view.window);  // as users get it
        return view;
    };
    const auto film_of = [&](std::uint32_t seed) { return sampler.film(view_of(seed)); };
    for (const std::uint64_t spp : plan.spp) curve.points.push_back({.spp = spp});
    for (std::uint32_t seed = 0; seed < plan.seeds; ++seed) {
        GrowingFilm film = film_of(seed + 1);
        if (seed == 0) {
            GrowingFilm first = film;
            if (!sampler.grow(first, 1, stop)) return std::nullopt;
            curve.first_picture_seconds = seconds(clock.now() - started);
            curve.memory_bytes = std::max(0.0, resident_bytes() - before);
        }
        for (TransportPoint& point : curve.points) {
            progress.say(scene.name + ", " + backend + ": " + std::to_string(point.spp) + " spp, seed " +
                         std::to_string(seed + 1) + " of " + std::to_string(plan.seeds));
            if (!sampler.grow(film, point.spp, stop)) return std::nullopt;
            add_picture(frame::resolve(film.whole(), frame::Channel::Radiance), truth, film.seconds(), plan,
                        point);
            point.rays += double(film.rays()) / (pixels * double(point.spp)) / seeds;
        }
    }
    progress.say(scene.name + ", " + backend + ": histogram of " + std::to_string(HistogramSeeds) +
                 " samples");
    for (std::uint32_t seed = 0; seed < HistogramSeeds; ++seed) {
        GrowingFilm film = film_of(plan.seeds + seed + 1);
        if (!sampler.grow(film, 1, stop)) return std::nullopt;
        curve.samples.merge(LuminanceHistogram(frame::resolve(film.whole(), frame::Channel::Radiance)));
    }
    // The noise of paths by their length hardly depends on the back-end: once is enough.
    if (backend != plan.backends.front()) return curve;
    progress.say(scene.name + ", " + backend + ": paths by their length");
    auto depths =
        measure_depths(sampler, view_of(plan.seeds + HistogramSeeds + 1), truth, plan.spp.back(), stop);
    if (!depths) return std::nullopt;
    curve.depths = std::move(*depths);
    return curve;
}

}  // namespace

void add_picture(const frame::Image& picture, const ReferencePair& truth, double seconds,
                 const TransportPlan& plan, TransportPoint& point) {
    const double seeds = plan.seeds;
    const SquaredErrors errors = squared_errors(picture, truth);
    add(point.relmse, errors.relmse.all, seeds);
    add(point.trimmed, errors.relmse.trimmed, seeds);
    point.flip += picture::hdr_flip_mean(picture, truth.mean()) / seeds;
    point.light += mean_luminance(picture) / mean_luminance(truth.mean()) / seeds;
    point.light_deviation = light_deviation(truth, double(point.spp) * seeds, double(plan.reference_spp));
    point.seconds += seconds / seeds;
}

double slope(const TransportCurve& curve, std::uint64_t from) {
    double n = 0.0, x = 0.0, y = 0.0, xx = 0.0, xy = 0.0;
    for (const TransportPoint& point : curve.points) {
        if (point.spp < from || !(point.relmse.value > 0.0)) continue;
        const double at = std::log(double(point.spp)), error = std::log(point.relmse.value);
        n += 1.0;
        x += at;
        y += error;
        xx += at * at;
        xy += at * error;
    }
    return n >= 2.0 ? (n * xy - x * y) / (n * xx - x * x) : 0.0;
}

double time_to_equal_error(const TransportCurve& curve, const TransportCurve& other) {
    if (curve.points.empty() || other.points.empty()) return 0.0;
    const TransportPoint &mine = curve.points.back(), &theirs = other.points.back();
    const double cost = theirs.relmse.value * theirs.seconds;
    return cost > 0.0 ? mine.relmse.value * mine.seconds / cost : 0.0;
}

std::optional<TransportScene> measure_transport(const BenchScene& scene, const TransportPlan& plan,
                                                tbb::task_arena& arena, const BenchProgress& progress,
                                                const std::stop_token& stop) {
    const auto truth = [&] {
        const Sampler sampler(scene, arena);
        return references(
            {.scene = scene.name,
             .content = to_hex(scene.content.state_hash()),
             .view = sampler.view(plan.size.width, plan.size.height, {}, view::PathClass::Indirect, 0),
             .spp = plan.reference_spp},
            sampler, ReferenceCache(plan.references), {progress.say, progress.warn}, stop);
    }();
    if (!truth) return std::nullopt;
    TransportScene result{.name = scene.name, .kind = scene.kind, .summary = scene.summary, .curves = {}};
    for (const std::string& backend : plan.backends) {
        auto curve = measure(backend, scene, plan, *truth, arena, progress, stop);
        if (!curve) return std::nullopt;
        result.curves.push_back(std::move(*curve));
    }
    if (plan.cycles) {
        auto curve = measure_cycles(scene, plan, progress, stop);
        if (stop.stop_requested()) return std::nullopt;
        if (curve) {
            result.curves.push_back(std::move(*curve));
        } else {
            progress.warn(scene.name + ": no curve of Cycles: " + curve.error().what());
        }
    }
    return result;
}

}  // namespace tessera::tools::bench
