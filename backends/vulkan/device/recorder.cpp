#include "backends/vulkan/device/recorder.h"

#include <algorithm>
#include <string>

#include "backends/vulkan/device/bindings.h"
#include "backends/vulkan/device/buffer.h"
#include "backends/vulkan/device/drawing.h"
#include "backends/vulkan/device/image.h"
#include "backends/vulkan/device/pipeline.h"
#include "backends/vulkan/device/result.h"
#include "backends/vulkan/device/step_check.h"

namespace tessera::vulkan {

namespace {

template <class... Functions>
struct Overloaded : Functions... {
    using Functions::operator()...;
};
template <class... Functions>
Overloaded(Functions...) -> Overloaded<Functions...>;

void check_dispatch(const Dispatch& dispatch, const DeviceInfo& info) {
    require(dispatch.pipeline != nullptr && dispatch.pipeline->get() != VK_NULL_HANDLE,
            "a dispatch without a pipeline");
    const std::string name = "kernel " + dispatch.pipeline->name();
    require(dispatch.arguments.size() == dispatch.pipeline->push_bytes(),
            name + " takes " + std::to_string(dispatch.pipeline->push_bytes()) +
                " bytes of arguments but got " + std::to_string(dispatch.arguments.size()));
    require(std::max({dispatch.groups.x, dispatch.groups.y, dispatch.groups.z}) <= info.max_groups,
            name + " has more groups along an axis than the device's limit of " +
                std::to_string(info.max_groups));
    check_bindings(dispatch, info);
    for (const auto* list : {&dispatch.reads, &dispatch.writes}) {
        for (const Buffer* buffer : *list) check_range(buffer, 0, 0, name);
    }
}

struct Scope {
    VkPipelineStageFlags2 stages;
    VkAccessFlags2 reads, writes;
};

Scope scope_of(StageMask mask) {
    Scope scope{};
    const auto add = [&](Stage stage, const Scope& one) {
        if ((mask & stage) == 0) return;
        scope.stages |= one.stages;
        scope.reads |= one.reads;
        scope.writes |= one.writes;
    };
    add(Compute,
        {VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, VK_ACCESS_2_SHADER_READ_BIT, VK_ACCESS_2_SHADER_WRITE_BIT});
    add(Transfer, {VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_READ_BIT,
                   VK_ACCESS_2_TRANSFER_WRITE_BIT});
    add(Indirect, {VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT, VK_ACCESS_2_INDIRECT_COMMAND_READ_BIT, 0});
    add(Host, {VK_PIPELINE_STAGE_2_HOST_BIT, VK_ACCESS_2_HOST_READ_BIT, VK_ACCESS_2_HOST_WRITE_BIT});
    add(Drawing, {VK_PIPELINE_STAGE_2_VERTEX_SHADER_BIT | VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT,
                  VK_ACCESS_2_SHADER_READ_BIT, 0});
    add(Attachment,
        {VK_PIPELINE_STAGE_2_EARLY_FRAGMENT_TESTS_BIT | VK_PIPELINE_STAGE_2_LATE_FRAGMENT_TESTS_BIT |
             VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT,
         VK_ACCESS_2_COLOR_ATTACHMENT_READ_BIT | VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_READ_BIT,
         VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT | VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT});
    return scope;
}

void memory_barrier(VkCommandBuffer commands, const VkMemoryBarrier2& barrier) {
    const VkDependencyInfo dependency{
        .sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO, .memoryBarrierCount = 1, .pMemoryBarriers = &barrier};
    vkCmdPipelineBarrier2(commands, &dependency);
}

// The handle identifies the bytes. A handle that is reused after its buffer's end can only cost a barrier,
// never miss one.
template <class Memory>  // a buffer or an image
Access access_to(const Memory* memory, Stage stage, Access::Kind kind) {
    return {reinterpret_cast<std::uint64_t>(memory->get()), stage, kind};
}

// Host-visible buffers that a step writes.
std::vector<const Buffer*> host_visible_writes(const Step& step) {
    std::vector<const Buffer*> written =
        std::visit(Overloaded{[](const Dispatch& dispatch) { return dispatch.writes; },
                              [](const Copy& copy) { return std::vector<const Buffer*>{copy.to}; },
                              [](const Fill& fill) { return std::vector<const Buffer*>{fill.buffer}; },
                              [](const CopyImage& copy) { return std::vector<const Buffer*>{copy.to}; },
                              [](const auto&) { return std::vector<const Buffer*>{}; }},
                   step);
    std::erase_if(written, [](const Buffer* buffer) { return buffer->mapped().empty(); });
    return written;
}

}  // namespace

void check_step(const Step& step, const DeviceInfo& info) {
    std::visit(Overloaded{[&](const Dispatch& dispatch) { check_dispatch(dispatch, info); },
                          [](const Copy& copy) {
                              check_range(copy.from, copy.from_offset, copy.bytes, "a copy");
                              check_range(copy.to, copy.to_offset, copy.bytes, "a copy");
                          },
                          [](const Fill& fill) {
                              check_range(fill.buffer, fill.offset, fill.bytes, "a fill");
                              require(fill.offset % 4 == 0 && fill.bytes % 4 == 0,
                                      "a fill that is not a multiple of 4 bytes");
                          },
                          [&](const DrawList& list) { check_draws(list, info); },
                          [](const CopyImage& copy) { check_copy(copy); },
                          [](const InitializeImage& initialize) {
                              require(
                                  initialize.image != nullptr && initialize.image->get() != VK_NULL_HANDLE,
                                  "an image initialization without an image");
                          },
                          [](const FullBarrier&) {}},
               step);
}

std::vector<Access> accesses_of(const Step& step) {
    using enum Access::Kind;
    std::vector<Access> accesses;
    const auto add = [&](const auto* memory, Stage stage, Access::Kind kind) {
        accesses.push_back(access_to(memory, stage, kind));
    };
    std::visit(
        Overloaded{[&](const Dispatch& dispatch) {
                       for (const Buffer* buffer : dispatch.reads) add(buffer, Compute, Read);
                       for (const Buffer* buffer : dispatch.writes) add(buffer, Compute, Write);
                   },
                   [&](const Copy& copy) {
                       add(copy.from, Transfer, Read);
                       add(copy.to, Transfer, Write);
                   },
                   [&](const Fill& fill) { add(fill.buffer, Transfer, Write); },
                   [&](const DrawList& list) {
                       for (const Buffer* buffer : list.reads) add(buffer, Drawing, Read);
                       add(list.draws, Indirect, Read);
                       add(list.ids, Attachment, Write);
                       add(list.depth, Attachment, Write);
                   },
                   [&](const CopyImage& copy) {
                       add(copy.from, Transfer, Read);
                       add(copy.to, Transfer, Write);
                   },
                   [&](const InitializeImage& initialize) { add(initialize.image, Attachment, Write); },
                   [](const FullBarrier&) {}},
        step);
    return accesses;
}

void Recorder::barrier(const Barrier& barrier) {
    const Scope sources = scope_of(barrier.sources), destinations = scope_of(barrier.destinations);
    const bool only_order = barrier.writers == 0;
    memory_barrier(commands_, {.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER_2,
                               .srcStageMask = sources.stages,
                               .srcAccessMask = scope_of(barrier.writers).writes,
                               .dstStageMask = destinations.stages,
                               .dstAccessMask = only_order ? 0 : destinations.reads | destinations.writes});
}

void Recorder::full_barrier() {
    memory_barrier(commands_,
                   {.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER_2,
                    .srcStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
                    .srcAccessMask = VK_ACCESS_2_MEMORY_WRITE_BIT,
                    .dstStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT | VK_PIPELINE_STAGE_2_HOST_BIT,
                    .dstAccessMask = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT |
                                     VK_ACCESS_2_HOST_READ_BIT});
    plan_.reset();
}

void Recorder::record_dispatch(const Dispatch& dispatch) {
    vkCmdBindPipeline(commands_, VK_PIPELINE_BIND_POINT_COMPUTE, dispatch.pipeline->get());
    const VkDescriptorSet set = make_set(device_, slot_.sets.get(), dispatch);
    if (set != VK_NULL_HANDLE) {
        vkCmdBindDescriptorSets(commands_, VK_PIPELINE_BIND_POINT_COMPUTE, dispatch.pipeline->layout(), 0, 1,
                                &set, 0, nullptr);
    }
    if (dispatch.arguments.size() > 0) {
        vkCmdPushConstants(commands_, dispatch.pipeline->layout(), VK_SHADER_STAGE_COMPUTE_BIT, 0,
                           dispatch.arguments.size(), dispatch.arguments.data());
    }
    vkCmdDispatch(commands_, dispatch.groups.x, dispatch.groups.y, dispatch.groups.z);
}

void Recorder::record(const Step& step) {
    if (const auto needed = plan_.before(accesses_of(step))) barrier(*needed);
    std::visit(Overloaded{[&](const Dispatch& dispatch) { record_dispatch(dispatch); },
                          [&](const Copy& copy) {
                              if (copy.bytes == 0) return;
                              const VkBufferCopy region{copy.from_offset, copy.to_offset, copy.bytes};
                              vkCmdCopyBuffer(commands_, copy.from->get(), copy.to->get(), 1, &region);
                          },
                          [&](const Fill& fill) {
                              if (fill.bytes == 0) return;
                              vkCmdFillBuffer(commands_, fill.buffer->get(), fill.offset, fill.bytes,
                                              fill.word);
                          },
                          [&](const DrawList& list) { record_draws(commands_, list); },
                          [&](const CopyImage& copy) { record_copy(commands_, copy); },
                          [&](const InitializeImage& initialize) {
                              record_image_initialization(commands_, *initialize.image);
                          },
                          [&](const FullBarrier&) { full_barrier(); }},
               step);
    for (const Buffer* buffer : host_visible_writes(step)) {
        host_writes_.push_back(access_to(buffer, Host, Access::Kind::Read));
    }
}

void Recorder::timestamp() {
    vkCmdWriteTimestamp2(commands_, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, slot_.queries.get(), stamp_++);
}

void Recorder::make_visible_to_host() {
    if (const auto needed = plan_.before(host_writes_)) barrier(*needed);
}

}  // namespace tessera::vulkan
