#include <optional>

#include "backends/vulkan/opened_device.h"
#include "backends/vulkan/ray_cast.h"
#include "backends/vulkan/vulkan_backend.h"
#include "backends/vulkan/world.h"
#include "mediator/shading/bvh_trace.h"
#include "tests/bench/backends/parts.h"

namespace tessera::bench {

namespace {

class VulkanCaster final : public RayCaster {
  public:
    VulkanCaster(const backend::BackendSettings& settings, const scene::ChangeList& snapshot,
                 vulkan::Trees trees)
        : opened_(vulkan::DeviceOpener(settings, {}).open()),
          world_(settings.blobs, settings.cache_folder, trees) {
        world_.move_to(&opened_->device);
        if (auto applied = world_.apply(snapshot); !applied) throw applied.error();
        if (auto committed = world_.commit(); !committed) throw committed.error();
    }

    void take(std::span<const shading::AskedRay> rays, Question question) override {
        const vulkan::GpuScene& scene = world_.scene();
        cast_.emplace(opened_->device, scene.pool(), scene.top(), rays,
                      vulkan::CastSettings{
                          .traversal = scene.traversal(),
                          .question = question == Question::Any ? shading::BvhAny : shading::BvhClosest});
    }

    void cast() override { cast_->run(); }
    std::vector<shading::Hit> hits() const override { return cast_->hits(); }

  private:
    std::unique_ptr<vulkan::OpenedDevice> opened_;
    vulkan::World world_;
    std::optional<vulkan::RayCast> cast_;
};

Contender contender_with(vulkan::Trees trees) {
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

Contender vulkan_contender() {
    Contender made = contender_with(vulkan::Trees::Wide);
    made.name = "vulkan";
    made.summary = "the Vulkan back-end";
    return made;
}

Contender vulkan_plain_contender() {
    Contender made = contender_with(vulkan::Trees::Plain);
    made.name = "vulkan-plain";
    made.summary = "the same on plain trees of two children";
    return made;
}

}  // namespace tessera::bench
