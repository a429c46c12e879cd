#include "backends/vulkan/device/memory.h"

#include <array>
#include <utility>

#include "backends/vulkan/device/result.h"

namespace tessera::vulkan {

Allocation::Allocation(Memory& memory, VkDeviceMemory object, std::byte* mapped, std::uint64_t size)
    : memory_(&memory), object_(object), mapped_(mapped), size_(size) {}

Allocation::Allocation(Allocation&& other) noexcept
    : memory_(std::exchange(other.memory_, nullptr)),
      object_(other.object_),
      mapped_(std::exchange(other.mapped_, nullptr)),
      size_(std::exchange(other.size_, 0)) {}

Allocation& Allocation::operator=(Allocation&& other) noexcept {
    std::swap(memory_, other.memory_);
    std::swap(object_, other.object_);
    std::swap(mapped_, other.mapped_);
    std::swap(size_, other.size_);
    return *this;
}

Allocation::~Allocation() {
    if (memory_ != nullptr) memory_->release(object_);
}

Memory::Memory(VkDevice device, const DeviceInfo& info) : device_(device) {
    vkGetPhysicalDeviceMemoryProperties(info.handle, &properties_);
}

// The first type that has what is wanted, most wanted first; the driver lists faster types first.
std::uint32_t Memory::choose_type(std::uint32_t allowed, MemoryKind kind) const {
    constexpr VkMemoryPropertyFlags Local = VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT;
    constexpr VkMemoryPropertyFlags Mapped =
        VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
    constexpr VkMemoryPropertyFlags Cached = VK_MEMORY_PROPERTY_HOST_CACHED_BIT;
    constexpr std::array<std::array<VkMemoryPropertyFlags, 3>, 3> Wishes{{
        {Local | Mapped | Cached, Local, 0},
        {Mapped | Local | Cached, Mapped, Mapped},
        {Mapped | Local | Cached, Mapped | Cached, Mapped},
    }};
    for (const VkMemoryPropertyFlags wish : Wishes[static_cast<std::size_t>(kind)]) {
        for (std::uint32_t i = 0; i < properties_.memoryTypeCount; ++i) {
            const bool fits = (properties_.memoryTypes[i].propertyFlags & wish) == wish;
            if (fits && (allowed >> i & 1u) != 0) return i;
        }
    }
    throw Error(ErrorCode::Internal, "no memory type of the device fits a buffer; report this");
}

Allocation Memory::allocate(const VkMemoryRequirements& needs, MemoryKind kind) {
    const VkMemoryAllocateFlagsInfo flags{.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_FLAGS_INFO,
                                          .flags = VK_MEMORY_ALLOCATE_DEVICE_ADDRESS_BIT};
    const std::uint32_t type = choose_type(needs.memoryTypeBits, kind);
    const VkMemoryAllocateInfo info{.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
                                    .pNext = &flags,
                                    .allocationSize = needs.size,
                                    .memoryTypeIndex = type};
    VkDeviceMemory object = VK_NULL_HANDLE;
    check(vkAllocateMemory(device_, &info, nullptr, &object),
          "allocate " + std::to_string(needs.size) + " bytes of device memory");
    if ((properties_.memoryTypes[type].propertyFlags & VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT) == 0) {
        return Allocation(*this, object, nullptr, needs.size);
    }
    void* mapped = nullptr;
    const VkResult result = vkMapMemory(device_, object, 0, VK_WHOLE_SIZE, 0, &mapped);
    if (result != VK_SUCCESS) release(object);
    check(result, "map device memory");
    return Allocation(*this, object, static_cast<std::byte*>(mapped), needs.size);
}

void Memory::release(VkDeviceMemory object) {
    vkFreeMemory(device_, object, nullptr);
}

}  // namespace tessera::vulkan
