#include "backends/vulkan/device/pipeline_cache.h"

#include <optional>

#include "backends/vulkan/device/result.h"

namespace tessera::vulkan {

namespace {

// A compiled kernel takes a few hundred KiB: enough for all variants for several drivers.
constexpr std::uint64_t ByteLimit = 64u << 20;

template <class T>
void update(Blake2b& hash, const T& value) {
    hash.update(std::as_bytes(std::span(&value, 1)));
}

void update(Blake2b& hash, std::span<const Constant> constants) {
    update(hash, constants.size());
    for (const Constant& constant : constants) update(hash, constant);
}

std::vector<std::byte> data_of(VkDevice device, VkPipelineCache cache) {
    std::size_t size = 0;
    check(vkGetPipelineCacheData(device, cache, &size, nullptr), "read a compiled kernel");
    std::vector<std::byte> data(size);
    check(vkGetPipelineCacheData(device, cache, &size, data.data()), "read a compiled kernel");
    data.resize(size);
    return data;
}

}  // namespace

PipelineCache::PipelineCache(VkDevice device, const DeviceInfo& info, const std::filesystem::path& folder)
    : device_(device), info_(info), files_(folder, "pipeline", ByteLimit) {}

void PipelineCache::update_with_driver(Blake2b& hash) const {
    update(hash, info_.cache_uuid);
    update(hash, info_.vendor_id);
    update(hash, info_.device_id);
    update(hash, info_.driver_version);
}

template <class Create>
Handle<VkPipeline, vkDestroyPipeline> PipelineCache::make(const Hash256& key, const std::string& name,
                                                          const Create& create) {
    const std::optional<std::vector<std::byte>> kept = files_.load(key);
    const VkPipelineCacheCreateInfo cache_info{.sType = VK_STRUCTURE_TYPE_PIPELINE_CACHE_CREATE_INFO,
                                               .initialDataSize = kept ? kept->size() : 0,
                                               .pInitialData = kept ? kept->data() : nullptr};
    VkPipelineCache object = VK_NULL_HANDLE;
    check(vkCreatePipelineCache(device_, &cache_info, nullptr, &object), "create a pipeline cache");
    const Handle<VkPipelineCache, vkDestroyPipelineCache> cache(device_, object);
    VkPipeline pipeline = VK_NULL_HANDLE;
    check(create(object, &pipeline), "compile kernel " + name);
    Handle<VkPipeline, vkDestroyPipeline> made(device_, pipeline);
    if (!kept) files_.save(key, data_of(device_, object));
    return made;
}

Handle<VkPipeline, vkDestroyPipeline> PipelineCache::make(const VkComputePipelineCreateInfo& info,
                                                          const PipelineSettings& settings) {
    Blake2b hash;
    update_with_driver(hash);
    update(hash, settings.push_bytes);
    update(hash, std::span(settings.constants));
    update(hash, settings.bindings.size());
    for (const Binding& binding : settings.bindings) {
        update(hash, binding.index);
        update(hash, binding.kind);
    }
    hash.update(std::as_bytes(settings.code));
    return make(hash.finish(), settings.name, [&](VkPipelineCache cache, VkPipeline* pipeline) {
        return vkCreateComputePipelines(device_, cache, 1, &info, nullptr, pipeline);
    });
}

Handle<VkPipeline, vkDestroyPipeline> PipelineCache::make(const VkGraphicsPipelineCreateInfo& info,
                                                          const GraphicsSettings& settings) {
    Blake2b hash;
    update_with_driver(hash);
    update(hash, settings.push_bytes);
    update(hash, std::span(settings.constants));
    update(hash, settings.vertex.size());
    hash.update(std::as_bytes(settings.vertex));
    hash.update(std::as_bytes(settings.fragment));
    return make(hash.finish(), settings.name, [&](VkPipelineCache cache, VkPipeline* pipeline) {
        return vkCreateGraphicsPipelines(device_, cache, 1, &info, nullptr, pipeline);
    });
}

}  // namespace tessera::vulkan
