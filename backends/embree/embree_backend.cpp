#include "backends/embree/embree_backend.h"

#include <algorithm>
#include <shared_mutex>
#include <thread>

#include "backends/embree/path_tracer.h"
#include "backends/embree/scene_adapter.h"
#include "mediator/backend/path_log.h"
#include "mediator/backend/sample_loop.h"
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
        require_renderer(view::TracingRenderers, view);
        const std::shared_lock lock(mutex_);
        if (unit.version != adapter_.version()) return {};
        const PathTracer tracer(adapter_.tables(), adapter_.scene(), view);
        return render_samples(unit, view.channels, [&](frame::FilmTile& tile, std::uint64_t& rays) {
            return fill(tile, tracer, rays, stop);
        });
    }

    std::vector<std::string> probe(const view::View& view, std::uint32_t x, std::uint32_t y,
                                   std::uint64_t sample) override {
        require_renderer(view::TracingRenderers, view);
        const std::shared_lock lock(mutex_);
        const PathTracer tracer(adapter_.tables(), adapter_.scene(), view);
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
