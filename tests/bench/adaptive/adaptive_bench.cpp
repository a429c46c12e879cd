#include "tests/bench/adaptive/adaptive_bench.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "mediator/filter/inputs.h"
#include "mediator/frame/resolve.h"
#include "tests/bench/adaptive/adaptive_film.h"
#include "tests/bench/filters/filter_run.h"
#include "tests/bench/filters/looks.h"
#include "tests/bench/filters/references.h"

namespace tessera::tools::bench {

namespace {

constexpr frame::ChannelSet AdaptiveChannels{frame::Channel::Radiance, frame::Channel::BlockVariance};

// Sums over the seeds.
struct Errors {
    double all = 0.0, trimmed = 0.0, light = 0.0;
    void add(const frame::Image& picture, const ReferencePair& truth) {
        const SquaredErrors errors = squared_errors(picture, truth);
        all += errors.relmse.all.value;
        trimmed += errors.relmse.trimmed.value;
        light += mean_luminance(picture);
    }
};

class AdaptiveMeasurement {
  public:
    AdaptiveMeasurement(const BenchScene& scene, const AdaptivePlan& plan, tbb::task_arena& arena,
                        const BenchProgress& progress, const std::stop_token& stop)
        : scene_(scene),
          plan_(plan),
          arena_(arena),
          progress_(progress),
          stop_(stop),
          sampler_(scene, arena) {}

    std::optional<AdaptiveScene> run() {
        const auto truth =
            references({.scene = scene_.name,
                        .content = to_hex(scene_.content.state_hash()),
                        .view = view(0),
                        .spp = plan_.reference_spp},
                       sampler_, ReferenceCache(plan_.references), {progress_.say, progress_.warn}, stop_);
        if (!truth) return std::nullopt;
        progress_.say(fmt::format("{}: units with masks", scene_.name));
        const auto rate = masked_rate(sampler_, view(1), arena_, stop_);
        if (!rate) return std::nullopt;
        AdaptiveScene result{.name = scene_.name, .masked_rate = *rate, .rows = {}};
        const std::uint64_t pixels = std::uint64_t{plan_.size.width} * plan_.size.height;
        for (const std::uint64_t spp : plan_.spp) {
            const auto row = measure({.samples = spp * pixels, .max_samples = MostSamples}, *truth);
            if (!row) return std::nullopt;
            result.rows.push_back(*row);
        }
        for (const double noise : plan_.noise) {
            const auto row = measure({.noise = noise, .max_samples = MostSamples}, *truth);
            if (!row) return std::nullopt;
            result.rows.push_back(*row);
        }
        for (const double error : plan_.errors) {
            const auto row = measure({.max_samples = MostSamples}, *truth, error);
            if (!row) return std::nullopt;
            result.rows.push_back(*row);
        }
        return result;
    }

  private:
    static constexpr std::uint64_t MostSamples = 1 << 16;  // of a pixel

    view::View view(std::uint64_t seed) const {
        frame::ChannelSet channels = AdaptiveChannels;
        if (plan_.filter) channels = channels | filter::wanted_channels(*plan_.filter, {});
        if (!plan_.errors.empty()) channels = channels | master::ErrorEstimateChannels;
        const auto path_class =
            plan_.filter ? plan_.filter->entry->description.path_class : view::PathClass::Indirect;
        view::View view = sampler_.view(plan_.size.width, plan_.size.height, channels, path_class, seed);
        if (plan_.filter) view.filter = filter::to_text(*plan_.filter);
        return view;
    }

    frame::Image picture(const frame::FilmTile& film, const view::View& view) const {
        if (!plan_.filter) return frame::resolve_picture(film);
        return FilterRun(*plan_.filter, plan_.size.width, plan_.size.height, arena_)
            .picture(filter::make_inputs(film, view));
    }

    std::string goal_text(const master::AdaptiveSettings& settings, double wanted_error) const {
        if (wanted_error > 0.0) return fmt::format("error {:g}", wanted_error);
        if (settings.noise > 0.0) return fmt::format("noise {:g}", settings.noise);
        return fmt::format("{} spp", settings.samples / (plan_.size.width * plan_.size.height));
    }

    std::optional<AdaptiveRow> measure(const master::AdaptiveSettings& settings, const ReferencePair& truth,
                                       double wanted_error = 0.0) {
        AdaptiveRow row{.noise = settings.noise,
                        .error = wanted_error,
                        .true_noise = {},
                        .true_error = {},
                        .estimated_error = {}};
        Errors adaptive, uniform;
        double sampling = 0.0, deciding = 0.0;
        for (std::uint32_t seed = 1; seed <= plan_.seeds; ++seed) {
            progress_.say(fmt::format("{}: {}, seed {} of {}", scene_.name, goal_text(settings, wanted_error),
                                      seed, plan_.seeds));
            const auto film = adaptive_film(sampler_, view(seed), settings,
                                            wanted_error > 0.0 ? &wanted_error : nullptr, arena_, stop_);
            if (!film) return std::nullopt;
            const double spp = double(film->samples) / double(film->whole.pixel_count());
            const frame::Image delivered = picture(film->whole, view(seed));
            adaptive.add(delivered, truth);
            if (wanted_error > 0.0) {
                const double true_error = squared_errors(delivered, truth).relmse.all.value;
                row.true_error.push_back(true_error / wanted_error);
                row.estimated_error.push_back(true_error / film->error);
            }
            const double error = squared_errors(frame::resolve_picture(film->whole), truth).relmse.all.value;
            row.true_noise.push_back(std::sqrt(std::max(0.0, error)) /
                                     (settings.noise > 0.0 ? settings.noise : film->noise));
            row.spp += spp / plan_.seeds;
            row.steps += double(film->steps) / plan_.seeds;
            sampling += film->seconds_sampling;
            deciding += film->seconds_deciding;
            GrowingFilm same = sampler_.film(view(seed));
            if (!sampler_.grow(same, static_cast<std::uint64_t>(std::lround(spp)), stop_))
                return std::nullopt;
            uniform.add(picture(same.whole(), view(seed)), truth);
        }
        row.gain = uniform.all / adaptive.all;
        row.trimmed_gain = uniform.trimmed / adaptive.trimmed;
        row.light = adaptive.light / uniform.light;
        row.deciding = deciding / (deciding + sampling);
        for (std::vector<double>* ratios : {&row.true_noise, &row.true_error, &row.estimated_error})
            std::ranges::sort(*ratios);
        return row;
    }

    const BenchScene& scene_;
    const AdaptivePlan& plan_;
    tbb::task_arena& arena_;
    const BenchProgress& progress_;
    const std::stop_token& stop_;
    Sampler sampler_;
};

}  // namespace

std::optional<AdaptiveScene> measure_adaptive(const BenchScene& scene, const AdaptivePlan& plan,
                                              tbb::task_arena& arena, const BenchProgress& progress,
                                              const std::stop_token& stop) {
    return AdaptiveMeasurement(scene, plan, arena, progress, stop).run();
}

}  // namespace tessera::tools::bench
