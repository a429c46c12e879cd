#include "backends/vulkan/vulkan_backend.h"

#include <algorithm>
#include <mutex>
#include <shared_mutex>

#include "backends/vulkan/opened_device.h"
#include "backends/vulkan/probe.h"
#include "backends/vulkan/scene_adapter.h"
#include "backends/vulkan/sky_cells.h"
#include "backends/vulkan/tile_renderer.h"
#include "mediator/backend/sky_cells_cache.h"
#include "mediator/backend/tables/media.h"
#include "mediator/backend/tables/view_record.h"
#include "mediator/base/float_mode.h"
#include "mediator/frame/render_revision.h"

namespace tessera::vulkan {

namespace {

using namespace backend;

constexpr frame::ChannelSet AllChannels = frame::ChannelSet::all();
constexpr int Attempts = 3;  // gives up after this many losses in a row

class VulkanBackend final : public Backend {
  public:
    VulkanBackend(const BackendSettings& settings, const DeviceSettings& device, Trees trees)
        : opener_(settings, device),
          threads_(settings.threads),
          adapter_(settings.blobs, settings.cache_folder, trees) {
        opened_ = opener_.open();
        adapter_.move_to(&opened_->device);
        const DeviceInfo& info = opened_->device.info();
        // GPUs need many samples at a time.
        view::RendererSet renderers = view::TracingRenderers;
        if (info.draws && trees == Trees::Wide) renderers.insert(view::Renderer::Raster);
        capabilities_ = {.channels = AllChannels,
                         .renderers = renderers,
                         .preferred_tile = info.kind == DeviceKind::Cpu ? 32u : 128u,
                         .concurrent_units = 2,  // one is merged while the other is traced
                         .deterministic = true,
                         .kind = frame::with_render_revision("vulkan " + info.name + ", " + info.driver)};
    }
    ~VulkanBackend() override {
        sky_cells_.clear();
        adapter_.move_to(nullptr);
    }

    Capabilities capabilities() const override { return capabilities_; }

    Version version() const override {
        const std::shared_lock lock(mutex_);
        return adapter_.version();
    }

    std::unique_ptr<EditScope> begin_edit() override { return std::make_unique<Edit>(*this); }

    RenderResult render(const view::View& view, const view::WorkUnit& unit, std::stop_token stop) override {
        const StandardFloatMode mode;
        require_renderer(capabilities_.renderers, view);
        return on_device([&]() -> RenderResult {
            if (unit.version != adapter_.version()) return {};
            shading::View record = record_of(view);
            std::shared_ptr<const DeviceSkyCells> sky_cells;  // outlives the unit
            if (unit.block.end() > view.sky_cells_from && record.renderer == shading::RendererPathTracing) {
                sky_cells = sky_cells_of(view, record, stop);
                if (sky_cells == nullptr) return {.status = RenderStatus::Stopped};
                sky_cells->use_in(record, view.sky_cells_from);
            }
            const bool rasters = record.renderer == shading::RendererRaster;
            const RasterTools tools{opened_->raster, opened_->targets, {}};
            const TileRenderer renderer{opened_->device,
                                        opened_->kernels,
                                        rasters ? opened_->raster_dispatch_budget : opened_->dispatch_budget,
                                        adapter_.scene(),
                                        features_for(adapter_.tables(), record),
                                        rasters ? &tools : nullptr,
                                        camera_keys(view.camera, adapter_.tables().render_origin)};
            return renderer.run(record, unit, view.channels, stop);
        });
    }

    std::vector<std::string> probe(const view::View& view, std::uint32_t x, std::uint32_t y,
                                   std::uint64_t sample) override {
        const StandardFloatMode mode;
        require_renderer(capabilities_.renderers, view);
        return on_device([&] {
            const std::vector<shading::Affine3x4> places =
                camera_keys(view.camera, adapter_.tables().render_origin);
            shading::View record = record_of(view);
            record.camera_keys.items = places.data();
            std::optional<SkyCells> sky_cells;
            if (sample >= view.sky_cells_from && record.renderer == shading::RendererPathTracing) {
                sky_cells = make_sky_cells(opened_->device, adapter_.scene(), adapter_.tables(), record,
                                           threads_, {});
                sky_cells->use_in(record, view.sky_cells_from);
            }
            return replay(opened_->device, adapter_.scene(), adapter_.tables(), record, {x, y}, sample);
        });
    }

  private:
    class Edit final : public EditScope {
      public:
        explicit Edit(VulkanBackend& backend) : backend_(backend), lock_(backend.mutex_) {}
        ~Edit() override { backend_.adapter_.rollback(); }  // committed changes are kept
        const scene::Scene& scene() const override { return backend_.adapter_.content(); }
        using EditScope::apply;
        Expected<void> apply(const scene::ChangeList& changes, const scene::Scene& after) override {
            return backend_.adapter_.apply(changes, after);
        }
        Expected<EditReport> commit() override { return backend_.commit(); }

      private:
        VulkanBackend& backend_;
        std::unique_lock<std::shared_mutex> lock_;
    };

    // Moving objects are traced: the rasteriser does not support motion blur.
    shading::View record_of(const view::View& view) const {
        shading::View record = make_view(view, adapter_.tables().render_origin);
        record.containing_media = media_around(adapter_.tables(), record);
        const bool moves = (adapter_.tables().scene.features & shading::FeatureMotion) != 0;
        if (moves && record.renderer == shading::RendererRaster) record.renderer = shading::RendererWhitted;
        return record;
    }

    // nullptr: stopped.
    std::shared_ptr<const DeviceSkyCells> sky_cells_of(const view::View& view, shading::View record,
                                                       const std::stop_token& stop) {
        return sky_cells_.find(adapter_.version(), view, [&]() -> std::shared_ptr<const DeviceSkyCells> {
            const std::vector<shading::Affine3x4> places =
                camera_keys(view.camera, adapter_.tables().render_origin);
            record.camera_keys.items = places.data();
            const std::optional<SkyCells> made =
                make_sky_cells(opened_->device, adapter_.scene(), adapter_.tables(), record, threads_, stop);
            return made ? std::make_shared<const DeviceSkyCells>(opened_->device, *made) : nullptr;
        });
    }

    // Runs `work` with the scene on the device, under the shared lock. Reopens a device that was lost, or that
    // could not be opened the last time, and retries.
    template <class Work>
    auto on_device(const Work& work) -> decltype(work()) {
        for (int attempt = 1;; ++attempt) {
            std::uint64_t seen = 0;
            try {
                const std::shared_lock lock(mutex_);
                seen = recoveries_;
                if (adapter_.is_on_device()) return work();
            } catch (const DeviceLost&) {
                if (attempt == Attempts) throw;
            }
            const std::unique_lock lock(mutex_);
            if (recoveries_ == seen) reopen();  // unless another thread has
        }
    }

    // Under the edit's lock.
    Expected<EditReport> commit() {
        for (int attempt = 1;; ++attempt) {
            try {
                if (!adapter_.is_on_device()) reopen();
                return adapter_.commit();
            } catch (const DeviceLost&) {
                if (attempt == Attempts) throw;
                adapter_.move_to(nullptr);
            }
        }
    }

    // Opens a new device and uploads the scene. Throws what opening throws; the scene is on no device then.
    void reopen() {
        ++recoveries_;
        adapter_.move_to(nullptr);
        sky_cells_.clear();
        opened_.reset();
        opened_ = opener_.open();
        adapter_.move_to(&opened_->device);
    }

    const DeviceOpener opener_;
    const std::uint32_t threads_;
    Capabilities capabilities_;
    mutable std::shared_mutex mutex_;  // shared by renders, exclusive for edits; protects everything below
    std::uint64_t recoveries_ = 0;
    std::unique_ptr<OpenedDevice> opened_;
    SceneAdapter adapter_;
    SkyCellsCache<DeviceSkyCells> sky_cells_;
};

}  // namespace

std::unique_ptr<Backend> make_backend(const BackendSettings& settings, const DeviceSettings& device,
                                      Trees trees) {
    return std::make_unique<VulkanBackend>(settings, device, trees);
}

BackendEntry entry() {
    return {.name = "vulkan",
            .summary = "path tracing on any device with Vulkan 1.3",
            .make = [](const BackendSettings& settings) { return make_backend(settings, {}); },
            .chooses_device = true};
}

}  // namespace tessera::vulkan
