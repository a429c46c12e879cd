#include "backends/null/null_backend.h"

#include <algorithm>
#include <array>
#include <condition_variable>
#include <mutex>
#include <shared_mutex>
#include <thread>

#include "backends/null/gradient.h"
#include "mediator/backend/sample_loop.h"
#include "mediator/backend/shadow_scene.h"
#include "mediator/base/float_mode.h"
#include "mediator/frame/merge.h"
#include "mediator/frame/render_revision.h"

namespace tessera::null_backend {

namespace {

using namespace backend;

constexpr frame::ChannelSet AllChannels = frame::ChannelSet::all();

class NullBackend final : public Backend {
  public:
    explicit NullBackend(const BackendSettings& settings) : settings_(settings) {}

    Capabilities capabilities() const override {
        const std::uint32_t cores = std::max(1u, std::thread::hardware_concurrency());
        return {.channels = AllChannels,
                .concurrent_units = settings_.threads ? settings_.threads : cores,
                .kind = frame::with_render_revision("null-1")};
    }

    Version version() const override {
        const std::shared_lock lock(mutex_);
        return shadow_.scene().version();
    }

    std::unique_ptr<EditScope> begin_edit() override { return std::make_unique<Edit>(*this); }

    RenderResult render(const view::View& view, const view::WorkUnit& unit, std::stop_token stop) override {
        const StandardFloatMode mode;
        require_renderer(view::TracingRenderers, view);
        const std::shared_lock lock(mutex_);
        if (unit.version != shadow_.scene().version()) return {};
        const std::uint64_t key = view_key(content_, view);
        return render_samples(unit, view.channels, [&](frame::FilmTile& tile, std::uint64_t& rays) {
            if (!fill(tile, view, key, stop) || !spend_time(tile.pixel_count(), stop)) return false;
            rays += tile.pixel_count();
            return true;
        });
    }

    std::vector<std::string> probe(const view::View& view, std::uint32_t x, std::uint32_t y,
                                   std::uint64_t sample) override {
        require_renderer(view::TracingRenderers, view);
        const std::shared_lock lock(mutex_);
        const Gradient values = gradient(view, shadow_.flat_scene(), view_key(content_, view),
                                         static_cast<std::int32_t>(x), static_cast<std::int32_t>(y), sample);
        return {"hit object " + std::to_string(values.object.value) + " at depth " +
                std::to_string(values.depth)};
    }

  private:
    class Edit final : public EditScope {
      public:
        explicit Edit(NullBackend& backend) : backend_(backend), lock_(backend.mutex_) {}
        ~Edit() override { backend_.shadow_.rollback(); }  // committed changes are kept

        const scene::Scene& scene() const override { return backend_.shadow_.scene(); }
        using EditScope::apply;
        Expected<void> apply(const scene::ChangeList& changes, const scene::Scene& after) override {
            return backend_.shadow_.apply(changes, after);
        }

        Expected<EditReport> commit() override {
            SceneDelta delta = backend_.shadow_.take_delta();
            const FlatScene& flat_scene = backend_.shadow_.flat_scene();
            backend_.content_ = content_key(backend_.shadow_);
            std::uint64_t triangles = 0;
            ObjectId previous;
            for (const Instance& instance : flat_scene.instances) {  // ascending by geometry
                const auto* geometry = backend_.shadow_.scene().find_as<scene::Geometry>(instance.geometry);
                if (instance.geometry != previous) triangles += geometry->indices.byte_size / 12;
                previous = instance.geometry;
            }
            return EditReport{.entries = delta.entries,
                              .relevant = delta.relevant,
                              .retransformed = static_cast<std::uint32_t>(delta.moved_instances.size()),
                              .triangles = triangles,
                              .instances = flat_scene.instances.size(),
                              .lights = flat_scene.lights.size(),
                              .ignored_kinds = std::move(delta.ignored_kinds)};
        }

      private:
        NullBackend& backend_;
        std::unique_lock<std::shared_mutex> lock_;
    };

    bool fill(frame::FilmTile& tile, const view::View& view, std::uint64_t key,
              const std::stop_token& stop) const {
        if (tile.channels == frame::ChannelSet{frame::Channel::Color})
            return fill_color(tile, view, key, stop);
        std::vector<float> values;
        return for_each_pixel(tile, stop, [&](std::size_t pixel, std::int32_t x, std::int32_t y) {
            const Gradient sample = gradient(view, shadow_.flat_scene(), key, x, y, tile.block.first);
            append_values(sample, tile.channels, values);
            frame::put_sample(tile, pixel, values);
            values.clear();
        });
    }

    // Fast path for colour only, as display walls use it.
    bool fill_color(frame::FilmTile& tile, const view::View& view, std::uint64_t key,
                    const std::stop_token& stop) const {
        std::fill(tile.counts.begin(), tile.counts.end(), 1u);
        const std::array planes{tile.plane(0), tile.plane(1), tile.plane(2)};
        return for_each_pixel(tile, stop, [&](std::size_t pixel, std::int32_t x, std::int32_t y) {
            const Colors light = colors(view, key, x, y, tile.block.first);
            for (std::size_t c = 0; c < 3; ++c) planes[c][pixel] = light.direct[c] + light.indirect[c];
        });
    }

    // Sleeps for the simulated cost, so that many nodes can be simulated on few cores. False: stopped.
    bool spend_time(std::size_t samples, const std::stop_token& stop) const {
        if (settings_.simulated_sample_cost.count() == 0) return true;
        std::mutex mutex;
        std::unique_lock lock(mutex);
        std::condition_variable_any stopped;
        stopped.wait_for(lock, stop, settings_.simulated_sample_cost * samples, [] { return false; });
        return !stop.stop_requested();
    }

    const BackendSettings settings_;
    mutable std::shared_mutex mutex_;  // shared by renders, exclusive for edits; protects everything below
    ShadowScene shadow_;
    std::uint64_t content_ = 0;
};

}  // namespace

backend::BackendEntry entry() {
    return {"null", "ids and gradients without tracing anything, for tests of the cluster",
            [](const BackendSettings& settings) { return std::make_unique<NullBackend>(settings); }};
}

}  // namespace tessera::null_backend
