#include "backends/vulkan/device/bindings.h"

#include <string>
#include <variant>
#include <vector>

#include "backends/vulkan/device/buffer.h"
#include "backends/vulkan/device/result.h"

namespace tessera::vulkan {

namespace {

Error misuse(const Dispatch& dispatch, const std::string& what) {
    return Error(ErrorCode::Internal, "kernel " + dispatch.pipeline->name() + " " + what + "; report this");
}

}  // namespace

std::uint32_t texel_bytes(VkFormat format) {
    switch (format) {
        case VK_FORMAT_R32G32B32A32_UINT:
        case VK_FORMAT_R32G32B32A32_SFLOAT:
            return 16;
        case VK_FORMAT_R32G32_UINT:
        case VK_FORMAT_R32G32_SFLOAT:
            return 8;
        case VK_FORMAT_R32_UINT:
        case VK_FORMAT_R32_SFLOAT:
        case VK_FORMAT_R8G8B8A8_UINT:
        case VK_FORMAT_R8G8B8A8_UNORM:
            return 4;
        default:
            throw Error(ErrorCode::Internal, "unsupported texel format: VkFormat " +
                                                 std::to_string(int(format)) + "; report this");
    }
}

void check_bindings(const Dispatch& dispatch, const DeviceInfo& info) {
    const std::vector<Binding>& bindings = dispatch.pipeline->bindings();
    if (dispatch.bound.size() != bindings.size()) {
        throw misuse(dispatch, "has " + std::to_string(bindings.size()) + " bindings but got " +
                                   std::to_string(dispatch.bound.size()) + " buffers");
    }
    for (std::size_t i = 0; i < bindings.size(); ++i) {
        const Buffer* buffer = dispatch.bound[i];
        const std::string name = "binding " + std::to_string(bindings[i].index);
        if (buffer == nullptr || buffer->get() == VK_NULL_HANDLE) throw misuse(dispatch, "lacks " + name);
        const bool is_storage = bindings[i].kind == Binding::Kind::Storage;
        const std::uint64_t limit =
            is_storage ? info.storage_range_bytes
                       : std::uint64_t(info.texel_elements) * texel_bytes(bindings[i].format);
        if (buffer->size() <= limit) continue;
        throw misuse(dispatch, "binds " + std::to_string(buffer->size()) + " bytes to " + name +
                                   ", but the device's limit is " + std::to_string(limit));
    }
}

BindingCount count_bindings(std::span<const Step> steps) {
    BindingCount count;
    for (const Step& step : steps) {
        const auto* dispatch = std::get_if<Dispatch>(&step);
        if (dispatch == nullptr || dispatch->bound.empty()) continue;
        ++count.sets;
        for (const Binding& binding : dispatch->pipeline->bindings()) {
            ++(binding.kind == Binding::Kind::Storage ? count.storage : count.texels);
        }
    }
    return count;
}

VkDescriptorSet make_set(VkDevice device, VkDescriptorPool pool, const Dispatch& dispatch) {
    if (dispatch.bound.empty()) return VK_NULL_HANDLE;
    const VkDescriptorSetLayout layout = dispatch.pipeline->set_layout();
    const VkDescriptorSetAllocateInfo info{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
                                           .descriptorPool = pool,
                                           .descriptorSetCount = 1,
                                           .pSetLayouts = &layout};
    VkDescriptorSet set = VK_NULL_HANDLE;
    check(vkAllocateDescriptorSets(device, &info, &set),
          "allocate a descriptor set for kernel " + dispatch.pipeline->name());

    const std::size_t count = dispatch.bound.size();
    std::vector<VkDescriptorBufferInfo> buffers(count);
    std::vector<VkBufferView> views(count);
    std::vector<VkWriteDescriptorSet> writes(count);
    for (std::size_t i = 0; i < count; ++i) {
        const Binding& binding = dispatch.pipeline->bindings()[i];
        writes[i] = {.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                     .dstSet = set,
                     .dstBinding = binding.index,
                     .descriptorCount = 1};
        if (binding.kind == Binding::Kind::Storage) {
            buffers[i] = {dispatch.bound[i]->get(), 0, VK_WHOLE_SIZE};
            writes[i].descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
            writes[i].pBufferInfo = &buffers[i];
        } else {
            views[i] = dispatch.bound[i]->texels(binding.format);
            writes[i].descriptorType = VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER;
            writes[i].pTexelBufferView = &views[i];
        }
    }
    vkUpdateDescriptorSets(device, static_cast<std::uint32_t>(count), writes.data(), 0, nullptr);
    return set;
}

}  // namespace tessera::vulkan
