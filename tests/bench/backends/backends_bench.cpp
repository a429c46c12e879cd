#include "tests/bench/backends/backends_bench.h"

#include <atomic>
#include <functional>

#include "mediator/base/clock.h"
#include "mediator/base/parallel.h"
#include "mediator/program/command_line.h"
#include "tests/bench/backends/scene_edits.h"
#include "tests/bench/backends/traversal_rays.h"

namespace tessera::tools::bench {

namespace {

using tessera::bench::RayQueryKind, tessera::bench::RayCaster;

class SceneRun {
  public:
    SceneRun(const BackendsPlan& plan, const EditedScene& scene, const BenchProgress& progress,
             const std::stop_token& stop)
        : plan_(plan), scene_(scene), progress_(progress), stop_(stop), results_(plan.targets.size()) {}

    std::optional<std::vector<TargetResult>> run() {
        for (std::size_t i = 0; i < results_.size(); ++i) results_[i].name = plan_.targets[i].target.name;
        if (!cast_rays()) return std::nullopt;
        // Round 0 is a warm-up: the driver compiles, caches fill.
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

    backend::BackendSettings settings(const BackendsPlan::Target& target) const {
        return {.threads = plan_.jobs, .device = target.device, .blobs = scene_.blobs};
    }

    double timed(const std::function<void()>& work) const {
        const TimePoint started = clock_.now();
        work();
        return seconds(clock_.now() - started);
    }

    bool cast_rays() {
        std::vector<std::unique_ptr<RayCaster>> casters;
        for (const auto& target : plan_.targets) {
            casters.push_back(target.target.make_caster(settings(target), scene_.snapshot));
        }
        const RaySets sets = ray_sets(scene_.scene, scene_.blobs, plan_.rays, *casters.front());
        return cast(casters, "primary_rays", sets.primary, RayQueryKind::Closest) &&
               cast(casters, "shadow_rays", sets.shadow, RayQueryKind::Any) &&
               cast(casters, "bounce_rays", sets.bounce, RayQueryKind::Closest);
    }

    bool cast(const std::vector<std::unique_ptr<RayCaster>>& casters, std::string_view measure,
              const std::vector<shading::RayQuery>& rays, RayQueryKind kind) {
        if (rays.empty()) return true;  // the camera sees nothing
        say(std::string(measure));
        for (const auto& caster : casters) {
            caster->take(rays, kind);
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

    // One round from the start of the back-end: scene, picture, edits with pictures, whole paths.
    bool whole_round(std::size_t index, bool counts) {
        const BackendsPlan::Target& target = plan_.targets[index];
        const auto renderer = target.target.make_backend(settings(target));
        results_[index].kind = renderer->capabilities().kind;
        Measurements ignored;
        Measurements& to = counts ? results_[index].measured : ignored;
        const auto applied_and_rendered = [&](const scene::ChangeList& changes, const std::string& name,
                                              const std::string& measure) {
            const double time = edit(*renderer, changes, name, to);
            const std::optional<Picture> shown_picture = picture(*renderer, 1);
            if (shown_picture) to.add(measure, time + shown_picture->seconds);
            return shown_picture.has_value();
        };
        if (!applied_and_rendered(scene_.snapshot, "build", "build_to_picture") ||
            !applied_and_rendered(scene_.deformation, "refit", "refit_to_picture") ||
            !applied_and_rendered(scene_.movement, "update", "update_to_picture")) {
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
    // Empty: stopped.
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
    std::vector<TargetResult> results_;
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
        auto targets = SceneRun(plan, scene, progress, stop).run();
        if (!targets) return std::nullopt;
        results.scenes.push_back(
            {name, scene.scene.summary, scene.triangles, scene.instances, std::move(*targets)});
        show(results.scenes.back());
    }
    results.seconds = seconds(clock.now() - started);
    return results;
}

}  // namespace tessera::tools::bench
