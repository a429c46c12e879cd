#include "tests/bench/filters/camera_path.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "mediator/frame/resolve.h"
#include "tests/bench/filters/filter_run.h"

namespace tessera::tools::bench {

namespace {

constexpr std::uint64_t FirstSeed = 31;

// The point in front of the camera at the median visible depth; at one metre if nothing is visible.
glm::dvec3 look_at_point(const Sampler& sampler, Size size) {
    const view::View view =
        sampler.view(size.width, size.height, {frame::Channel::Depth}, view::PathClass::None, 0);
    GrowingFilm film = sampler.film(view);
    sampler.grow(film, 1, {});
    std::vector<float> depths = frame::resolve(film.whole(), frame::Channel::Depth).values;
    std::erase_if(depths, [](float depth) { return !std::isfinite(depth); });
    double depth = 1.0;
    if (!depths.empty()) {
        const auto median = depths.begin() + static_cast<std::ptrdiff_t>(depths.size() / 2);
        std::nth_element(depths.begin(), median, depths.end());
        depth = *median;
    }
    const glm::dmat4& m = view.camera.world_from_camera;
    return glm::dvec3(m[3]) - depth * glm::dvec3(m[2]);
}

class PathBench {
  public:
    explicit PathBench(const PathBenchInput& input)
        : input_(input), size_(input.plan.sizes.front().size), centre_(look_at_point(input.sampler, size_)) {}

    std::optional<PathResult> run() {
        PathResult result{input_.plan.path_views, DegreesPerView, input_.plan.path_reference_spp, {}};
        for (std::uint32_t i = 0; i < input_.plan.path_views; ++i) {
            auto pair = references({.scene = input_.scene.name + "-path" + std::to_string(i),
                                    .content = to_hex(input_.scene.content.state_hash()),
                                    .view = view({}, view::PathClass::Indirect, i),
                                    .spp = input_.plan.path_reference_spp},
                                   input_.sampler, ReferenceCache(input_.plan.references),
                                   {input_.progress.say, input_.progress.warn}, input_.stop);
            if (!pair) return std::nullopt;
            references_.push_back(std::move(*pair));
        }
        for (const std::uint64_t spp : input_.plan.path_spp) {
            for (const FilmGroup& group : input_.groups) {
                if (!measure_group(group, spp, result)) return std::nullopt;
            }
        }
        return result;
    }

  private:
    view::View view(frame::ChannelSet channels, view::PathClass path_class, std::uint32_t step) const {
        view::View view =
            input_.sampler.view(size_.width, size_.height, channels, path_class, FirstSeed + step);
        const double angle = glm::radians(DegreesPerView * step);
        const glm::dmat4 turn = glm::translate(glm::dmat4(1.0), centre_) *
                                glm::rotate(glm::dmat4(1.0), angle, glm::dvec3(0.0, 1.0, 0.0)) *
                                glm::translate(glm::dmat4(1.0), -centre_);
        view.camera.world_from_camera = turn * view.camera.world_from_camera;
        view.revision = step + 1;
        return view;
    }

    // Frame by frame, so that only one film is in memory at a time.
    bool measure_group(const FilmGroup& group, std::uint64_t spp, PathResult& result) {
        std::vector<FilterRun> runs;
        std::vector<PathRow> rows;
        std::vector<frame::Image> before(group.filters.size());
        for (const std::size_t i : group.filters) {
            runs.emplace_back(input_.plan.filters[i], size_.width, size_.height, input_.arena);
            rows.push_back({to_text(input_.plan.filters[i]), spp, {}, {}});
        }
        for (std::uint32_t step = 0; step < input_.plan.path_views; ++step) {
            input_.progress.say(input_.scene.name + ": camera path, " + std::to_string(spp) + " spp, view " +
                                std::to_string(step + 1) + " of " + std::to_string(input_.plan.path_views));
            GrowingFilm film = input_.sampler.film(view(group.channels, group.path_class, step));
            if (!input_.sampler.grow(film, spp, input_.stop)) return false;
            filter::Inputs inputs = filter::make_inputs(film.whole(), film.view());
            inputs.changes.film_restarted = true;
            for (std::size_t i = 0; i < runs.size(); ++i) {
                if (input_.stop.stop_requested()) return false;
                frame::Image picture = runs[i].next_picture(inputs);
                add_errors(rows[i], step, before[i], picture);
                before[i] = std::move(picture);
            }
        }
        for (PathRow& row : rows) {
            finish(row.temporal, input_.plan.path_views - 1);
            finish(row.relmse, input_.plan.path_views - input_.plan.path_views / 2);
        }
        result.rows.insert(result.rows.end(), rows.begin(), rows.end());
        return true;
    }

    void add_errors(PathRow& row, std::uint32_t step, const frame::Image& before,
                    const frame::Image& picture) const {
        const ReferencePair& here = references_[step];
        if (step > 0) add(row.temporal, temporal_relmse(before, picture, references_[step - 1], here));
        if (step >= input_.plan.path_views / 2) add(row.relmse, squared_errors(picture, here).relmse);
    }

    // Sums of values and of squared deviations; finish() turns them into means.
    static void add(Estimate& sum, const Estimate& one) {
        sum.value += one.value;
        sum.deviation += one.deviation * one.deviation;
    }
    static void add(RelativeErrors& sum, const RelativeErrors& one) {
        add(sum.all, one.all);
        add(sum.trimmed, one.trimmed);
    }
    static void finish(RelativeErrors& sum, std::uint32_t count) {
        const double n = std::max(1u, count);
        for (Estimate* part : {&sum.all, &sum.trimmed})
            *part = {part->value / n, std::sqrt(part->deviation) / n};
    }

    const PathBenchInput& input_;
    Size size_;
    glm::dvec3 centre_;
    std::vector<ReferencePair> references_;
};

}  // namespace

std::optional<PathResult> measure_path(const PathBenchInput& input) {
    return PathBench(input).run();
}

}  // namespace tessera::tools::bench
