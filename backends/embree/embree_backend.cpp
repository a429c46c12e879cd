#include "backends/embree/embree_backend.h"

#include <algorithm>
#include <shared_mutex>
#include <thread>

#include "backends/embree/path_tracer.h"
#include "backends/embree/scene_adapter.h"
#include "mediator/backend/path_log.h"
#include "mediator/backend/sample_loop.h"
#include "mediator/backend/sky_cells_cache.h"
#include "mediator/base/float_mode.h"
#include "mediator/frame/merge.h"
#include "mediator/shading/sample_values.h"

namespace tessera::embree {

namespace {

using namespace backend;

constexpr frame::ChannelSet AllChannels = frame::ChannelSet::all();

class EmbreeBackend final : public Backend {
  public:
    explicit EmbreeBackend(const BackendSettings& settings)
        : settings_(settings), device_(make_device(settings)), adapter_(device_.get(), settings.blobs) {}

    Capabilities capabilities() const override {
        const std::uint32_t cores = std::max(1u, std::thread::hardware_concurrency());
        return {.channels = AllChannels,
                .preferred_tile = 32,
                .concurrent_units = settings_.threads != 0 ? settings_.threads : cores,
                .deterministic = true,
                .kind = kind_of(settings_)};
    }

    Version version() const override {
        const std::shared_lock lock(mutex_);
        return adapter_.version();
    }

    std::unique_ptr<EditScope> begin_edit() override { return std::make_unique<Edit>(*this); }

    RenderResult render(const view::View& view, const view::WorkUnit& unit, std::stop_token stop) override {
        const StandardFloatMode mode;
        require_renderer(view::TracingRenderers, view);
        const std::shared_lock lock(mutex_);
        if (unit.version != adapter_.version()) return {};
        PathTracer tracer(adapter_.tables(), adapter_.scene(), view);
        const auto sky_cells = sky_cells_of(tracer, view, unit.block.end(), stop);
        if (sky_cells == nullptr) return {.status = RenderStatus::Stopped};
        tracer.use_sky_cells(*sky_cells, view.sky_cells_from);
        return render_samples(unit, view.channels, [&](frame::FilmTile& tile, std::uint64_t& rays) {
            return fill(tile, tracer, rays, stop);
        });
    }

    std::vector<std::string> probe(const view::View& view, std::uint32_t x, std::uint32_t y,
                                   std::uint64_t sample) override {
        const StandardFloatMode mode;
        require_renderer(view::TracingRenderers, view);
        const std::shared_lock lock(mutex_);
        PathTracer tracer(adapter_.tables(), adapter_.scene(), view);
        const auto sky_cells = sky_cells_of(tracer, view, sample + 1, {});
        tracer.use_sky_cells(*sky_cells, view.sky_cells_from);
        std::vector<std::string> path_log;
        std::uint64_t rays = 0;
        const PathSample found = tracer.trace(x, y, sample, rays, &path_log);
        const glm::vec3 radiance = shading::radiance_of(found);
        write_end(path_log, radiance, rays);
        return path_log;
    }

  private:
    class Edit final : public EditScope {
      public:
        explicit Edit(EmbreeBackend& backend) : backend_(backend), lock_(backend.mutex_) {}
        ~Edit() override { backend_.adapter_.rollback(); }  // committed changes are kept
        const scene::Scene& scene() const override { return backend_.adapter_.content(); }
        using EditScope::apply;
        Expected<void> apply(const scene::ChangeList& changes, const scene::Scene& after) override {
            return backend_.adapter_.apply(changes, after);
        }
        Expected<EditReport> commit() override { return backend_.adapter_.commit(); }

      private:
        EmbreeBackend& backend_;
        std::unique_lock<std::shared_mutex> lock_;
    };

    // Empty ones if no sample before `end` needs any; nullptr: stopped.
    std::shared_ptr<const SkyCells> sky_cells_of(const PathTracer& tracer, const view::View& view,
                                                 std::uint64_t end, const std::stop_token& stop) {
        if (end <= view.sky_cells_from || view.renderer != view::Renderer::PathTracing) return no_sky_cells_;
        return sky_cells_.find(adapter_.version(), view, [&]() -> std::shared_ptr<const SkyCells> {
            std::optional<SkyCells> made = tracer.make_sky_cells(settings_.threads, stop);
            return made ? std::make_shared<const SkyCells>(std::move(*made)) : nullptr;
        });
    }

    static bool fill(frame::FilmTile& tile, const PathTracer& tracer, std::uint64_t& rays,
                     const std::stop_token& stop) {
        return for_each_pixel(tile, stop, [&](std::size_t pixel, std::int32_t x, std::int32_t y) {
            const PathSample sample = tracer.trace(static_cast<std::uint32_t>(x),
                                                   static_cast<std::uint32_t>(y), tile.block.first, rays);
            const shading::SampleValues values = shading::sample_values(tracer.view(), sample);
            frame::put_sample(tile, pixel, {values.items, values.count});
        });
    }

    const BackendSettings settings_;
    const std::shared_ptr<const SkyCells> no_sky_cells_ = std::make_shared<const SkyCells>();
    SkyCellsCache<SkyCells> sky_cells_;
    DeviceHandle device_;
    mutable std::shared_mutex mutex_;  // shared by renders, exclusive for edits; protects the adapter
    SceneAdapter adapter_;
};

}  // namespace

backend::BackendEntry entry() {
    return {"embree", "path tracing on the CPU with Intel Embree",
            [](const BackendSettings& settings) { return std::make_unique<EmbreeBackend>(settings); }};
}

}  // namespace tessera::embree
