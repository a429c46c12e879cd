#pragma once

#include <vulkan/vulkan_core.h>

#include <chrono>
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "backends/vulkan/device/device_list.h"
#include "backends/vulkan/device/handle.h"
#include "backends/vulkan/device/step.h"

namespace tessera::vulkan {

class Queue;

// Steps on their way. Dropping it abandons them: they run to their end unobserved.
class Submission final {
  public:
    Submission() = default;  // of nothing: done

    bool done() const;
    // Both throw DeviceLost.
    void wait() const;
    bool wait_for(std::chrono::nanoseconds time) const;  // false: not done yet

  private:
    friend class Queue;
    struct Slot;
    Queue* queue_ = nullptr;
    std::shared_ptr<Slot> slot_;
    std::uint64_t ticket_ = 0;
};

// Runs steps on the device, in the order of submission as far as their reads and writes demand. Thread-safe.
class Queue final {
  public:
    Queue(VkDevice device, const DeviceInfo& info, std::uint32_t family);
    ~Queue();  // waits for everything
    Queue(const Queue&) = delete;
    Queue& operator=(const Queue&) = delete;

    // Returns at once. The steps see everything that the host wrote before. Throws DeviceLost, or
    // Error{Internal} for a step that is none: a pass without a pipeline, arguments of another size, more
    // groups than the device allows, a part beyond a buffer's end.
    Submission submit(std::span<const Step> steps);
    Submission submit(const Step& step) { return submit(std::span(&step, 1)); }
    void wait_idle();  // until all that was submitted is done; throws DeviceLost

    // Keeps `object` until everything submitted so far is done.
    void retire(std::shared_ptr<void> object);

  private:
    friend class Submission;
    struct Retired {
        std::uint64_t ticket;
        std::shared_ptr<void> object;
    };

    std::shared_ptr<Submission::Slot> free_slot();
    void record(VkCommandBuffer commands, std::span<const Step> steps) const;
    std::uint64_t completed() const;
    bool wait_for(std::uint64_t ticket, std::uint64_t nanoseconds) const;
    void collect();

    VkDevice device_;
    const DeviceInfo& info_;
    std::uint32_t family_;
    VkQueue queue_ = VK_NULL_HANDLE;
    Handle<VkSemaphore, vkDestroySemaphore> timeline_;

    std::mutex mutex_;  // protects all below
    std::uint64_t submitted_ = 0;
    std::vector<std::shared_ptr<Submission::Slot>> slots_;
    std::vector<Retired> retired_;
};

}  // namespace tessera::vulkan
