#include <optional>

#include "backends/vulkan/opened_device.h"
#include "backends/vulkan/ray_cast.h"
#include "backends/vulkan/scene_adapter.h"
#include "backends/vulkan/vulkan_backend.h"
#include "mediator/shading/bvh_trace.h"
#include "tests/bench/backends/target_factories.h"

namespace tessera::bench {

namespace {

class VulkanCaster final : public RayCaster {
  public:
    VulkanCaster(const backend::BackendSettings& settings, const scene::ChangeList& snapshot,
                 vulkan::Trees trees)
        : opened_(vulkan::DeviceOpener(settings, {}).open()),
          adapter_(settings.blobs, settings.cache_folder, trees) {
        adapter_.move_to(&opened_->device);
        if (auto applied = adapter_.apply(snapshot); !applied) throw applied.error();
        if (auto committed = adapter_.commit(); !committed) throw committed.error();
    }

    void take(std::span<const shading::RayQuery> rays, RayQueryKind question) override {
        const vulkan::GpuScene& scene = adapter_.scene();
        cast_.emplace(opened_->device, scene.pool(), scene.top(), rays,
                      vulkan::CastSettings{
                          .traversal = scene.traversal(),
                          .question = question == RayQueryKind::Any ? shading::BvhAny : shading::BvhClosest});
    }

    void cast() override { cast_->run(); }
    std::vector<shading::Hit> hits() const override { return cast_->hits(); }

  private:
    std::unique_ptr<vulkan::OpenedDevice> opened_;
    vulkan::SceneAdapter adapter_;
    std::optional<vulkan::RayCast> cast_;
};

BenchTarget target_with(vulkan::Trees trees) {
    return {.chooses_device = true,
            .make_backend =
                [trees](const backend::BackendSettings& settings) {
                    return vulkan::make_backend(settings, {}, trees);
                },
            .make_caster =
                [trees](const backend::BackendSettings& settings, const scene::ChangeList& snapshot) {
                    return std::make_unique<VulkanCaster>(settings, snapshot, trees);
                }};
}

}  // namespace

BenchTarget vulkan_target() {
    BenchTarget target = target_with(vulkan::Trees::Wide);
    target.name = "vulkan";
    target.summary = "the Vulkan back-end";
    return target;
}

BenchTarget vulkan_plain_target() {
    BenchTarget target = target_with(vulkan::Trees::Bvh2);
    target.name = "vulkan-plain";
    target.summary = "the Vulkan back-end with a binary BVH";
    return target;
}

}  // namespace tessera::bench
