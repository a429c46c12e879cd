#include "tests/bench/filters/scene_bench.h"

#include <algorithm>

#include "tests/bench/filters/camera_path.h"
#include "tests/bench/filters/crops.h"
#include "tests/bench/filters/curve.h"
#include "tests/bench/filters/film_groups.h"
#include "tests/bench/filters/filter_run.h"

namespace tessera::tools::bench {

namespace {

constexpr std::uint64_t FilmSeed = 0;
constexpr std::uint64_t MostSppOfCrops = 16;
constexpr std::int32_t CropWidth = 256, CropHeight = 144;
// About the size of a filter's inputs: 16 planes of floats.
constexpr std::size_t WorkingSetBytesPerPixel = 64;

// The references of one size, and how its pictures are displayed.
struct Comparison {
    const ReferencePair& references;
    Display display;
    Rect crop;
    bool keeps_crops;
};

class SceneBench {
  public:
    SceneBench(const BenchScene& scene, const BenchPlan& plan, tbb::task_arena& arena,
               const BenchProgress& progress, const std::stop_token& stop)
        : scene_(scene),
          plan_(plan),
          arena_(arena),
          progress_(progress),
          stop_(stop),
          sampler_(scene, arena),
          cost_(sampler_, plan.sizes.front().size),
          groups_(film_groups(plan.filters)) {}

    std::optional<SceneResult> run() {
        SceneResult result{scene_.name, scene_.kind, scene_.summary, to_hex(scene_.content.state_hash()),
                           {},          {}};
        for (const SizePlan& size : plan_.sizes) {
            auto measured = measure_size(size, &size == &plan_.sizes.back());
            if (!measured) return std::nullopt;
            result.sizes.push_back(std::move(*measured));
        }
        if (!plan_.path_spp.empty()) {
            auto path = measure_path({scene_, plan_, sampler_, groups_, arena_, progress_, stop_});
            if (!path) return std::nullopt;
            result.path = std::move(*path);
        }
        return result;
    }

  private:
    std::optional<SizeResult> measure_size(const SizePlan& size, bool keeps_crops) {
        const auto [width, height] = size.size;
        const auto pair =
            references({.scene = scene_.name,
                        .content = to_hex(scene_.content.state_hash()),
                        .view = sampler_.view(width, height, {}, view::PathClass::Indirect, FilmSeed),
                        .spp = size.reference_spp},
                       sampler_, ReferenceCache(plan_.references), {progress_.say, progress_.warn}, stop_);
        if (!pair) return std::nullopt;
        SizeResult result{.width = width, .height = height, .reference_spp = size.reference_spp};
        result.noise_mse = pair->noise_mse();
        result.noise_relmse = pair->noise_relmse();
        result.copy_bytes_per_second =
            copy_bandwidth(std::size_t{width} * height * WorkingSetBytesPerPixel, arena_);
        const Comparison comparison{*pair, Display(pair->mean()),
                                    most_detailed(pair->mean(), CropWidth, CropHeight), keeps_crops};
        result.crop_width = static_cast<std::uint32_t>(comparison.crop.width);
        result.crop_height = static_cast<std::uint32_t>(comparison.crop.height);
        if (keeps_crops)
            result.reference_crop = comparison.display.pixels(cropped(pair->mean(), comparison.crop));

        for (const FilmGroup& group : groups_) {
            if (!measure_group(size, group, comparison, result)) return std::nullopt;
        }
        order(result.rows);
        compare_with_unfiltered(result);
        return result;
    }

    bool measure_group(const SizePlan& size, const FilmGroup& group, const Comparison& comparison,
                       SizeResult& result) {
        const auto [width, height] = size.size;
        std::vector<FilterRun> runs;
        for (const std::size_t i : group.filters) runs.emplace_back(plan_.filters[i], width, height, arena_);
        GrowingFilm film =
            sampler_.film(sampler_.view(width, height, group.channels, group.path_class, FilmSeed));
        for (const std::uint64_t spp : size.spp) {
            const std::string at = scene_.name + ": " + std::to_string(width) + "x" + std::to_string(height) +
                                   ", " + std::to_string(spp) + " spp";
            progress_.say(at);
            if (!sampler_.grow(film, spp, stop_)) return false;
            const filter::Inputs inputs = filter::make_inputs(film.whole(), film.view());
            for (std::size_t i = 0; i < runs.size(); ++i) {
                if (stop_.stop_requested()) return false;
                const filter::Choice& choice = plan_.filters[group.filters[i]];
                progress_.say(at + ", " + to_text(choice));
                Row row =
                    measure_filter(runs[i], choice, inputs, comparison, spp, result.copy_bytes_per_second);
                row.sampling_seconds = double(spp) * double(width) * double(height) *
                                       cost_.of(filter::wanted_channels(choice, {}), group.path_class, stop_);
                result.rows.push_back(std::move(row));
            }
        }
        return true;
    }

    static Row measure_filter(FilterRun& run, const filter::Choice& choice, const filter::Inputs& inputs,
                              const Comparison& comparison, std::uint64_t spp, double copy_bytes_per_second) {
        Row row{.filter = to_text(choice), .spp = spp};
        const frame::Image picture = run.picture(inputs, &row.notes);
        row.errors = squared_errors(picture, comparison.references);
        row.seen = perceptual_errors(picture, comparison.references);
        row.time = run.time(inputs, copy_bytes_per_second);
        if (comparison.keeps_crops && spp <= MostSppOfCrops)
            row.crop = comparison.display.pixels(cropped(picture, comparison.crop));
        return row;
    }

    void order(std::vector<Row>& rows) const {
        const auto index_of = [&](const Row& row) {
            return std::find_if(plan_.filters.begin(), plan_.filters.end(),
                                [&](const filter::Choice& choice) { return to_text(choice) == row.filter; });
        };
        std::stable_sort(rows.begin(), rows.end(), [&](const Row& a, const Row& b) {
            return a.spp != b.spp ? a.spp < b.spp : index_of(a) < index_of(b);
        });
    }

    static void compare_with_unfiltered(SizeResult& result) {
        compare_by(result, &RelativeErrors::all, &Row::all);
        compare_by(result, &RelativeErrors::trimmed, &Row::trimmed);
    }

    static void compare_by(SizeResult& result, Estimate RelativeErrors::*kind,
                           RelativeToUnfiltered Row::*member) {
        std::vector<CurvePoint> by_spp, by_time;
        for (const Row& row : result.rows) {
            if (row.filter != "none") continue;
            const double error = (row.errors.relmse.*kind).value;
            by_spp.push_back({double(row.spp), error});
            by_time.push_back({row.sampling_seconds, error});
        }
        const ErrorCurve over_spp(by_spp), over_time(by_time);
        for (Row& row : result.rows) {
            const Estimate error = row.errors.relmse.*kind;
            RelativeToUnfiltered& relative = row.*member;
            const Row* unfiltered = result.find("none", row.spp);
            const double base = unfiltered ? (unfiltered->errors.relmse.*kind).value : 0.0;
            if (base > 0.0) relative.to_unfiltered = error.value / base;
            if (!(error.value > error.deviation)) continue;
            const ErrorCurve::Reading samples = over_spp.cost_of(error.value);
            relative.equal_error = {samples.value / double(row.spp), samples.is_measured};
            const double filter_seconds = row.filter == "none" ? 0.0 : row.time.seconds;
            const ErrorCurve::Reading same_time = over_time.error_at(row.sampling_seconds + filter_seconds);
            relative.equal_time = {same_time.value / error.value, same_time.is_measured};
        }
    }

    const BenchScene& scene_;
    const BenchPlan& plan_;
    tbb::task_arena& arena_;
    const BenchProgress& progress_;
    const std::stop_token& stop_;
    Sampler sampler_;
    SamplingCost cost_;
    std::vector<FilmGroup> groups_;
};

}  // namespace

const Row* SizeResult::find(const std::string& filter, std::uint64_t spp) const {
    const auto found = std::find_if(rows.begin(), rows.end(),
                                    [&](const Row& row) { return row.filter == filter && row.spp == spp; });
    return found == rows.end() ? nullptr : &*found;
}

std::optional<SceneResult> measure_scene(const BenchScene& scene, const BenchPlan& plan,
                                         tbb::task_arena& arena, const BenchProgress& progress,
                                         const std::stop_token& stop) {
    return SceneBench(scene, plan, arena, progress, stop).run();
}

}  // namespace tessera::tools::bench
