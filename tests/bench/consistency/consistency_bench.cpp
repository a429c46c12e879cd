#include "tests/bench/consistency/consistency_bench.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "mediator/picture/metrics.h"
#include "tests/bench/consistency/rare_light.h"
#include "tests/bench/filters/film_groups.h"
#include "tests/bench/filters/filter_run.h"
#include "tests/bench/filters/looks.h"

namespace tessera::tools::bench {

namespace {

// One picture.
struct Measured {
    double all = 0.0, trimmed = 0.0;  // relMSE
    double light = 0.0, specks = 0.0, ssim = 0.0;
};

// By the index of the number of samples, that of the filter, and the seed.
using Pictures = std::map<std::pair<std::size_t, std::size_t>, std::vector<Measured>>;

class Measurement {
  public:
    Measurement(const BenchScene& scene, const ConsistencyPlan& plan, tbb::task_arena& arena,
                const BenchProgress& progress, const std::stop_token& stop)
        : scene_(scene),
          plan_(plan),
          arena_(arena),
          progress_(progress),
          stop_(stop),
          sampler_(scene, arena),
          groups_(film_groups(plan.filters)) {}

    std::optional<ConsistencyScene> run() {
        const auto truth = references(
            {.scene = scene_.name,
             .content = to_hex(scene_.content.state_hash()),
             .view = sampler_.view(plan_.size.width, plan_.size.height, {}, view::PathClass::Indirect, 0),
             .spp = plan_.reference_spp},
            sampler_, ReferenceCache(plan_.references), {progress_.say, progress_.warn}, stop_);
        if (!truth) return std::nullopt;
        for (std::uint32_t seed = 0; seed < plan_.seeds; ++seed) {
            for (const FilmGroup& group : groups_) {
                if (!measure(group, seed, *truth)) return std::nullopt;
            }
        }
        return result();
    }

  private:
    bool measure(const FilmGroup& group, std::uint32_t seed, const ReferencePair& truth) {
        const auto [width, height] = plan_.size;
        GrowingFilm film =
            sampler_.film(sampler_.view(width, height, group.channels, group.path_class, seed + 1));
        for (std::size_t n = 0; n < plan_.spp.size(); ++n) {
            progress_.say(
                fmt::format("{}: seed {} of {}, {} spp", scene_.name, seed + 1, plan_.seeds, plan_.spp[n]));
            if (!sampler_.grow(film, plan_.spp[n], stop_)) return false;
            const frame::FilmTile whole = film.whole();
            const filter::Inputs inputs = filter::make_inputs(whole, film.view());
            for (const std::size_t f : group.filters) {
                if (stop_.stop_requested()) return false;
                const frame::Image picture =
                    FilterRun(plan_.filters[f], width, height, arena_).picture(inputs);
                const SquaredErrors errors = squared_errors(picture, truth);
                pictures_[{n, f}].push_back({.all = errors.relmse.all.value,
                                             .trimmed = errors.relmse.trimmed.value,
                                             .light = mean_luminance(picture),
                                             .specks = speck_fraction(picture, truth.mean()),
                                             .ssim = picture::ssim(picture, truth.mean())});
            }
            if (seed != 0 || n + 1 != plan_.spp.size() || !rare_light_.empty()) continue;
            for (const std::uint64_t spp : plan_.spp) rare_light_.push_back(rare_light(whole, spp));
        }
        return true;
    }

    static double mean(const std::vector<Measured>& pictures, double Measured::*value) {
        double sum = 0.0;
        for (const Measured& picture : pictures) sum += picture.*value;
        return sum / double(pictures.size());
    }

    static ErrorRatio ratio(const std::vector<Measured>& pictures, const std::vector<Measured>& unfiltered,
                            double Measured::*error) {
        std::size_t good = 0;
        for (std::size_t i = 0; i < pictures.size(); ++i)
            good += pictures[i].*error <= MostSingleRatio * (unfiltered[i].*error) ? 1u : 0u;
        return {mean(pictures, error) / mean(unfiltered, error), double(good) / double(pictures.size())};
    }

    ConsistencyScene result() const {
        ConsistencyScene scene{.name = scene_.name, .cells = {}, .slopes = {}};
        for (std::size_t n = 0; n < plan_.spp.size(); ++n) {
            const auto& unfiltered = pictures_.at({n, 0});
            for (std::size_t f = 0; f < plan_.filters.size(); ++f) {
                const auto& pictures = pictures_.at({n, f});
                scene.cells.push_back(
                    {.filter = to_text(plan_.filters[f]),
                     .spp = plan_.spp[n],
                     .all = ratio(pictures, unfiltered, &Measured::all),
                     .trimmed = ratio(pictures, unfiltered, &Measured::trimmed),
                     .energy = mean(pictures, &Measured::light) / mean(unfiltered, &Measured::light),
                     .specks = mean(pictures, &Measured::specks),
                     .ssim = mean(pictures, &Measured::ssim),
                     .rare_light = rare_light_[n]});
            }
        }
        const auto first = static_cast<std::size_t>(
            std::ranges::find_if(plan_.spp, [](std::uint64_t spp) { return spp >= SlopeFrom; }) -
            plan_.spp.begin());
        if (first + 1 >= plan_.spp.size()) return scene;
        const auto fall = [&](std::size_t f) {
            return std::log(mean(pictures_.at({plan_.spp.size() - 1, f}), &Measured::all) /
                            mean(pictures_.at({first, f}), &Measured::all));
        };
        for (std::size_t f = 1; f < plan_.filters.size(); ++f)
            scene.slopes.emplace_back(to_text(plan_.filters[f]), fall(f) / fall(0));
        return scene;
    }

    const BenchScene& scene_;
    const ConsistencyPlan& plan_;
    tbb::task_arena& arena_;
    const BenchProgress& progress_;
    const std::stop_token& stop_;
    Sampler sampler_;
    std::vector<FilmGroup> groups_;
    Pictures pictures_;
    std::vector<double> rare_light_;  // by the index of the number of samples
};

}  // namespace

std::vector<std::string> broken_promises(const ConsistencyScene& scene) {
    std::vector<std::string> lines;
    for (const ConsistencyCell& cell : scene.cells) {
        const std::string at = fmt::format("{}, {}, {} spp: ", scene.name, cell.filter, cell.spp);
        const double most = cell.has_rare_light() ? MostMeanRatioOfRareLight : MostMeanRatio;
        for (const auto& [kind, error] :
             {std::pair("relMSE", &cell.all), std::pair("trimmed relMSE", &cell.trimmed)}) {
            if (error->mean > most)
                lines.push_back(fmt::format("{}{} is {:.3f} times that of the samples (at most {})", at, kind,
                                            error->mean, most));
            else if (error->single < LeastSingleFraction && !cell.has_rare_light())
                lines.push_back(fmt::format(
                    "{}{} is at most {} times that of the samples in {:.0f} % of the "
                    "pictures (at least {:.0f} %)",
                    at, kind, MostSingleRatio, 100.0 * error->single, 100.0 * LeastSingleFraction));
        }
        if (std::fabs(cell.energy - 1.0) > MostEnergyChange)
            lines.push_back(fmt::format("{}has {:.3f} times the light (within {:.0f} %)", at, cell.energy,
                                        100.0 * MostEnergyChange));
    }
    for (const auto& [filter, slope] : scene.slopes) {
        if (slope < LeastSlope)
            lines.push_back(
                fmt::format("{}, {}: the error falls {:.2f} times as fast as without it (at least "
                            "{})",
                            scene.name, filter, slope, LeastSlope));
    }
    return lines;
}

std::optional<ConsistencyScene> measure_consistency(const BenchScene& scene, const ConsistencyPlan& plan,
                                                    tbb::task_arena& arena, const BenchProgress& progress,
                                                    const std::stop_token& stop) {
    return Measurement(scene, plan, arena, progress, stop).run();
}

}  // namespace tessera::tools::bench
