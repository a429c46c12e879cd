#include "tests/bench/backends/backends_bench.h"

#include <atomic>
#include <functional>

#include "mediator/base/clock.h"
#include "mediator/base/parallel.h"
#include "mediator/program/command_line.h"
#include "tests/bench/backends/bare_rays.h"
#include "tests/bench/backends/scene_edits.h"

namespace tessera::tools::bench {

namespace {

using tessera::bench::Question, tessera::bench::RayCaster;

class SceneRun {
  public:
    SceneRun(const BackendsPlan& plan, const EditedScene& scene, const BenchProgress& progress,
             const std::stop_token& stop)
        : plan_(plan), scene_(scene), progress_(progress), stop_(stop), results_(plan.entrants.size()) {}

    std::optional<std::vector<ContenderResult>> run() {
        for (std::size_t i = 0; i < results_.size(); ++i) results_[i].name = plan_.entrants[i].contender.name;
        if (!cast_rays()) return std::nullopt;
        // A round that does not count: the driver compiles, caches fill.
        for (std::uint32_t round = 0; round <= plan_.repeat; ++round) {
            for (std::size_t i = 0; i < results_.size(); ++i) {
                say(results_[i].name + ", round " + std::to_string(round) + " of " +
                    std::to_string(plan_.repeat));
                if (!whole_round(i, round > 0)) return std::nullopt;
            }
        }
        return std::move(results_);
    }

  private:
    void say(const std::string& text) const { progress_.say(scene_.scene.name + ": " + text); }

    backend::BackendSettings settings(const BackendsPlan::Entrant& entrant) const {
        return {.threads = plan_.jobs, .device = entrant.device, .blobs = scene_.blobs};
    }

    double timed(const std::function<void()>& work) const {
        const TimePoint started = clock_.now();
        work();
        return seconds(clock_.now() - started);
    }

    bool cast_rays() {
        std::vector<std::unique_ptr<RayCaster>> casters;
        for (const auto& entrant : plan_.entrants) {
            casters.push_back(entrant.contender.make_caster(settings(entrant), scene_.everything));
        }
        const RaySets sets = ray_sets(scene_.scene, scene_.blobs, plan_.rays, *casters.front());
        return cast(casters, "primary_rays", sets.primary, Question::Closest) &&
               cast(casters, "shadow_rays", sets.shadow, Question::Any) &&
               cast(casters, "bounce_rays", sets.bounce, Question::Closest);
    }

    bool cast(const std::vector<std::unique_ptr<RayCaster>>& casters, std::string_view measure,
              const std::vector<shading::AskedRay>& rays, Question question) {
        if (rays.empty()) return true;  // the camera sees nothing
        say(std::string(measure));
        for (const auto& caster : casters) {
            caster->take(rays, question);
            caster->cast();
        }
        for (std::uint32_t round = 0; round < plan_.repeat; ++round) {
            for (std::size_t i = 0; i < casters.size(); ++i) {
                if (stop_.stop_requested()) return false;
                const double time = timed([&] { casters[i]->cast(); });
                results_[i].measured.add(measure, double(rays.size()) / time);
            }
        }
        return true;
    }

    // A back-end from its start: the scene, a picture, edits, a picture, paths.
    bool whole_round(std::size_t index, bool counts) {
        const BackendsPlan::Entrant& entrant = plan_.entrants[index];
        const auto renderer = entrant.contender.make_backend(settings(entrant));
        results_[index].kind = renderer->capabilities().kind;
        Measurements ignored;
        Measurements& to = counts ? results_[index].measured : ignored;
        const auto shown = [&](const scene::ChangeList& changes, const std::string& name,
                               const std::string& measure) {
            const double time = edit(*renderer, changes, name, to);
            const std::optional<Picture> made = picture(*renderer, 1);
            if (made) to.add(measure, time + made->seconds);
            return made.has_value();
        };
        if (!shown(scene_.everything, "build", "build_to_picture") ||
            !shown(scene_.vertices, "refit", "refit_to_picture") ||
            !shown(scene_.place, "update", "update_to_picture")) {
            return false;
        }
        const std::optional<Picture> paths = picture(*renderer, plan_.spp);
        if (!paths) return false;
        to.add("samples", paths->samples / paths->seconds);
        to.add("path_rays", paths->rays / paths->seconds);
        return true;
    }

    double edit(backend::Backend& renderer, const scene::ChangeList& changes, const std::string& measure,
                Measurements& to) const {
        backend::EditReport report;
        const double time = timed([&] {
            const auto scope = renderer.begin_edit();
            if (auto applied = scope->apply(changes); !applied) throw applied.error();
            auto committed = scope->commit();
            if (!committed) throw committed.error();
            report = std::move(*committed);
        });
        to.add(measure, time);
        to.add(measure + "_bytes", double(report.uploaded_bytes));
        return time;
    }

    struct Picture {
        double seconds = 0.0, samples = 0.0, rays = 0.0;
    };
    // Nothing: stopped.
    std::optional<Picture> picture(backend::Backend& renderer, std::uint64_t spp) const {
        const backend::Capabilities can = renderer.capabilities();
        const auto edge = static_cast<std::int32_t>(can.preferred_tile);
        const view::View view = view_of(plan_.size);
        std::vector<Rect> tiles;
        for (std::int32_t y = 0; y < view.window.height; y += edge) {
            for (std::int32_t x = 0; x < view.window.width; x += edge) {
                tiles.push_back(intersection({x, y, edge, edge}, view.window));
            }
        }
        const auto blocks = frame::aligned_blocks(0, spp);
        tbb::task_arena arena(static_cast<int>(can.concurrent_units));
        std::atomic<std::uint64_t> rays = 0;
        std::atomic<bool> done = true;
        const double time = timed([&] {
            parallel_for(arena, tiles.size(), [&](std::size_t i) {
                for (const frame::SampleBlock& block : blocks) {
                    const backend::RenderResult result = renderer.render(
                        view, {.version = renderer.version(), .tile = tiles[i], .block = block}, stop_);
                    rays += result.rays;
                    if (result.status != backend::RenderStatus::Done) done = false;
                }
            });
        });
        if (!done) return std::nullopt;
        const double samples = double(view.width) * view.height * double(spp);
        return Picture{time, samples, double(rays)};
    }

    view::View view_of(Size size) const {
        const import::CameraInfo& camera = scene_.scene.camera;
        return {
            .id = ViewId{1},
            .camera = view::perspective(camera.world_from_camera, camera.camera.vertical_fov,
                                        double(size.width) / double(size.height)),
            .width = size.width,
            .height = size.height,
            .window = {0, 0, static_cast<std::int32_t>(size.width), static_cast<std::int32_t>(size.height)},
            .max_bounces = scene_.scene.max_bounces,
            .channels = {frame::Channel::Radiance}};
    }

    const BackendsPlan& plan_;
    const EditedScene& scene_;
    const BenchProgress& progress_;
    const std::stop_token& stop_;
    SteadyClock clock_;
    std::vector<ContenderResult> results_;
};

}  // namespace

std::optional<BackendsResults> run_backends(const BackendsPlan& plan, const BenchProgress& progress,
                                            const std::function<void(const BackendsScene&)>& show,
                                            const std::stop_token& stop) {
    const SteadyClock clock;
    const TimePoint started = clock.now();
    BackendsResults results{.software = "tessera " + cli::version(),
                            .threads = plan.jobs,
                            .width = plan.size.width,
                            .height = plan.size.height,
                            .rays = plan.rays,
                            .repeat = plan.repeat,
                            .spp = plan.spp};
    for (const std::string& name : plan.scenes) {
        progress.say(name + ": loading");
        auto loaded = load_scene(name, plan.assets);
        if (!loaded) throw loaded.error();
        const EditedScene scene = with_edits(std::move(*loaded));
        auto contenders = SceneRun(plan, scene, progress, stop).run();
        if (!contenders) return std::nullopt;
        results.scenes.push_back(
            {name, scene.scene.summary, scene.triangles, scene.instances, std::move(*contenders)});
        show(results.scenes.back());
    }
    results.seconds = seconds(clock.now() - started);
    return results;
}

}  // namespace tessera::tools::bench
