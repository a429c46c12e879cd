#include "backends/vulkan/device/memory.h"

#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include "backends/vulkan/device/handle.h"
#include "backends/vulkan/device/result.h"

namespace tessera::vulkan {

struct MemoryBlock {
    Handle<VkDeviceMemory, vkFreeMemory> object;
    RangeAllocator ranges;
    std::byte* mapped = nullptr;
    std::uint32_t type = 0;
};

namespace {

// Large enough that hundreds of blocks hold any scene (drivers promise 4096 allocations), small enough that
// the last one wastes little; a heap of 2 GiB still has 32.
constexpr std::uint64_t BlockBytes = 64u << 20;

std::string shortage(std::uint64_t asked, const HeapUse& heap, std::uint64_t available) {
    return "out of device memory: " + std::to_string(asked) + " bytes requested, " +
           std::to_string(heap.used) + " used, " + std::to_string(available + (heap.reserved - heap.used)) +
           " available (possibly fragmented); use a smaller scene or a device with more memory";
}

}  // namespace

Allocation::Allocation(Allocation&& other) noexcept
    : memory_(std::exchange(other.memory_, nullptr)),
      block_(std::exchange(other.block_, nullptr)),
      offset_(other.offset_),
      size_(other.size_) {}

Allocation& Allocation::operator=(Allocation&& other) noexcept {
    std::swap(memory_, other.memory_);
    std::swap(block_, other.block_);
    std::swap(offset_, other.offset_);
    std::swap(size_, other.size_);
    return *this;
}

Allocation::~Allocation() {
    if (memory_ != nullptr) memory_->release(*block_, offset_, size_);
}

VkDeviceMemory Allocation::get() const {
    return block_ != nullptr ? block_->object.get() : VK_NULL_HANDLE;
}

std::byte* Allocation::mapped() const {
    return block_ != nullptr && block_->mapped != nullptr ? block_->mapped + offset_ : nullptr;
}

Memory::Memory(VkDevice device, const DeviceInfo& info, const MemorySettings& settings)
    : device_(device), info_(info), settings_(settings) {
    vkGetPhysicalDeviceMemoryProperties(info.handle, &properties_);
    blocks_.resize(properties_.memoryTypeCount);
    for (std::uint32_t i = 0; i < properties_.memoryHeapCount; ++i) {
        heaps_.push_back(
            {.device_local = (properties_.memoryHeaps[i].flags & VK_MEMORY_HEAP_DEVICE_LOCAL_BIT) != 0});
    }
}

Memory::~Memory() = default;

// The first type with the desired properties, the most desired first; drivers list faster types first.
std::uint32_t Memory::choose_type(std::uint32_t allowed, MemoryKind kind) const {
    constexpr VkMemoryPropertyFlags Local = VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT;
    constexpr VkMemoryPropertyFlags Mapped =
        VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
    constexpr VkMemoryPropertyFlags Cached = VK_MEMORY_PROPERTY_HOST_CACHED_BIT;
    constexpr std::array<std::array<VkMemoryPropertyFlags, 3>, 3> PreferredFlags{{
        {Local | Mapped | Cached, Local, 0},
        {Mapped | Local | Cached, Mapped, Mapped},
        {Mapped | Local | Cached, Mapped | Cached, Mapped},
    }};
    for (const VkMemoryPropertyFlags wanted : PreferredFlags[static_cast<std::size_t>(kind)]) {
        for (std::uint32_t i = 0; i < properties_.memoryTypeCount; ++i) {
            const bool fits = (properties_.memoryTypes[i].propertyFlags & wanted) == wanted;
            if (fits && (allowed >> i & 1u) != 0) return i;
        }
    }
    throw Error(ErrorCode::Internal, "no memory type of the device suits a buffer; report this");
}

// Memory of other programs is known only where the driver reports it.
std::uint64_t Memory::available(std::uint32_t heap) const {
    const std::uint64_t reserved = heaps_[heap].reserved;
    std::uint64_t total = properties_.memoryHeaps[heap].size;
    if (info_.memory_budget) {
        VkPhysicalDeviceMemoryBudgetPropertiesEXT budget{
            .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MEMORY_BUDGET_PROPERTIES_EXT};
        VkPhysicalDeviceMemoryProperties2 properties{
            .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MEMORY_PROPERTIES_2, .pNext = &budget};
        vkGetPhysicalDeviceMemoryProperties2(info_.handle, &properties);
        total = std::min<std::uint64_t>(total, budget.heapBudget[heap]);
    }
    if (settings_.limit != 0) total = std::min(total, settings_.limit);
    return total > reserved ? total - reserved : 0;
}

MemoryBlock& Memory::add_block(std::uint32_t type, const VkMemoryRequirements& needs, MemoryKind kind) {
    const std::uint32_t heap = properties_.memoryTypes[type].heapIndex;
    if (needs.size > available(heap)) free_empty_blocks();
    const std::uint64_t left = available(heap);
    if (needs.size > left || needs.size > info_.allocation_bytes) {
        throw Error(ErrorCode::OutOfMemory,
                    shortage(needs.size, heaps_[heap], std::min(left, info_.allocation_bytes)));
    }
    // Large allocations get their own block, so that no small unusable rest is left.
    const bool is_large = needs.size > BlockBytes / 2;
    const std::uint64_t size = is_large ? needs.size : std::max(needs.size, std::min(BlockBytes, left));
    const VkMemoryAllocateFlagsInfo flags{.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_FLAGS_INFO,
                                          .flags = VK_MEMORY_ALLOCATE_DEVICE_ADDRESS_BIT};
    const VkMemoryAllocateInfo info{.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
                                    .pNext = &flags,
                                    .allocationSize = size,
                                    .memoryTypeIndex = type};
    VkDeviceMemory object = VK_NULL_HANDLE;
    const VkResult allocated = vkAllocateMemory(device_, &info, nullptr, &object);
    if (allocated == VK_ERROR_OUT_OF_DEVICE_MEMORY || allocated == VK_ERROR_OUT_OF_HOST_MEMORY) {
        throw Error(ErrorCode::OutOfMemory,
                    result_name(allocated) + ": " + shortage(needs.size, heaps_[heap], left));
    }
    check(allocated, "allocate device memory");
    auto block = std::make_unique<MemoryBlock>(
        MemoryBlock{.object = {device_, object}, .ranges = RangeAllocator(size), .type = type});
    const bool is_visible =
        (properties_.memoryTypes[type].propertyFlags & VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT) != 0;
    const bool stays_apart =
        settings_.mapping == MemorySettings::Mapping::Separate && kind == MemoryKind::Device;
    if (is_visible && !stays_apart) {
        void* mapped = nullptr;
        check(vkMapMemory(device_, object, 0, VK_WHOLE_SIZE, 0, &mapped), "map device memory");
        block->mapped = static_cast<std::byte*>(mapped);
    }
    heaps_[heap].reserved += size;
    return *blocks_[type].emplace_back(std::move(block));
}

Allocation Memory::allocate(const VkMemoryRequirements& needs, MemoryKind kind) {
    const std::uint32_t type = choose_type(needs.memoryTypeBits, kind);
    const bool apart = settings_.mapping == MemorySettings::Mapping::Separate;
    const std::scoped_lock lock(mutex_);
    Allocation result;
    const auto take = [&](MemoryBlock& block) {
        // With Mapping::Separate one type serves two kinds, one of which is not mapped.
        if (apart && (block.mapped == nullptr) != (kind == MemoryKind::Device)) return false;
        const auto offset = block.ranges.allocate(needs.size, needs.alignment);
        if (!offset) return false;
        result.block_ = &block;
        result.offset_ = *offset;
        return true;
    };
    const bool found = std::any_of(blocks_[type].begin(), blocks_[type].end(),
                                   [&](const auto& block) { return take(*block); });
    if (!found) take(add_block(type, needs, kind));
    result.memory_ = this;
    result.size_ = needs.size;
    heaps_[properties_.memoryTypes[type].heapIndex].used += needs.size;
    return result;
}

void Memory::release(MemoryBlock& block, std::uint64_t offset, std::uint64_t size) {
    const std::scoped_lock lock(mutex_);
    block.ranges.release(offset, size);
    heaps_[properties_.memoryTypes[block.type].heapIndex].used -= size;
    if (!block.ranges.empty()) return;
    // One empty block is kept, so that repeated allocation at the edge of a block does not call the driver.
    const Blocks& blocks = blocks_[block.type];
    const auto empty =
        std::count_if(blocks.begin(), blocks.end(), [](const auto& other) { return other->ranges.empty(); });
    if (empty > 1 || block.ranges.size() > BlockBytes)
        free_blocks(block.type, [&](const MemoryBlock& other) { return &other == &block; });
}

template <class Condition>
void Memory::free_blocks(std::uint32_t type, Condition condition) {
    std::erase_if(blocks_[type], [&](const auto& block) {
        if (!condition(*block)) return false;
        heaps_[properties_.memoryTypes[type].heapIndex].reserved -= block->ranges.size();
        return true;
    });
}

void Memory::free_empty_blocks() {
    for (std::uint32_t type = 0; type < blocks_.size(); ++type) {
        free_blocks(type, [](const MemoryBlock& block) { return block.ranges.empty(); });
    }
}

std::vector<HeapUse> Memory::use() const {
    const std::scoped_lock lock(mutex_);
    std::vector<HeapUse> result = heaps_;
    for (std::uint32_t i = 0; i < result.size(); ++i) result[i].available = available(i);
    return result;
}

}  // namespace tessera::vulkan
