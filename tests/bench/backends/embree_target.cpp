#include <algorithm>
#include <thread>

#include "backends/embree/context.h"
#include "backends/embree/embree_backend.h"
#include "backends/embree/scene_adapter.h"
#include "mediator/base/parallel.h"
#include "mediator/shading/bvh_trace.h"
#include "tests/bench/backends/target_factories.h"

namespace tessera::bench {

namespace {

constexpr std::size_t Chunk = 1024;  // rays of one task

class EmbreeCaster final : public RayCaster {
  public:
    EmbreeCaster(const backend::BackendSettings& settings, const scene::ChangeList& snapshot)
        : device_(embree::make_device(settings)),
          adapter_(device_.get(), settings.blobs),
          arena_(static_cast<int>(settings.threads != 0 ? settings.threads
                                                        : std::thread::hardware_concurrency())) {
        if (auto applied = adapter_.apply(snapshot); !applied) throw applied.error();
        if (auto committed = adapter_.commit(); !committed) throw committed.error();
        scene_ = backend::on_host(adapter_.tables());
        view_.layers = shading::AllLayers;
    }

    void take(std::span<const shading::RayQuery> rays, RayQueryKind kind) override {
        rays_.assign(rays.begin(), rays.end());
        hits_.resize(rays.size());
        kind_ = kind;
    }

    void cast() override {
        const embree::Context context{{}, scene_, view_, adapter_.scene()};
        parallel_for(arena_, (rays_.size() + Chunk - 1) / Chunk, [&](std::size_t chunk) {
            const std::size_t end = std::min(rays_.size(), (chunk + 1) * Chunk);
            for (std::size_t i = chunk * Chunk; i < end; ++i) hits_[i] = hit_of(context, rays_[i]);
        });
    }

    std::vector<shading::Hit> hits() const override { return hits_; }

  private:
    shading::Hit hit_of(const embree::Context& context, const shading::RayQuery& ray) const {
        shading::Hit hit{.instance = shading::NoInstance};
        if (kind_ == RayQueryKind::Any) {
            shading::ThinWalls walls;
            if (embree::trace_occluded(context, ray.origin, ray.direction, ray.far, {}, walls))
                hit.instance = 0;
        } else {
            embree::trace_closest(context, {ray.origin, ray.direction}, {}, shading::skip_nothing(), hit);
        }
        return hit;
    }

    embree::DeviceHandle device_;
    embree::SceneAdapter adapter_;
    tbb::task_arena arena_;
    shading::Scene scene_;
    shading::View view_{};
    std::vector<shading::RayQuery> rays_;
    std::vector<shading::Hit> hits_;
    RayQueryKind kind_ = RayQueryKind::Closest;
};

}  // namespace

BenchTarget embree_target() {
    return {.name = "embree",
            .summary = "the Embree back-end",
            .make_backend = embree::entry().make,
            .make_caster = [](const backend::BackendSettings& settings, const scene::ChangeList& snapshot) {
                return std::make_unique<EmbreeCaster>(settings, snapshot);
            }};
}

}  // namespace tessera::bench
