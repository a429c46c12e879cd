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

void check_pass(const Pass& pass, const DeviceInfo& info) {
    require(pass.pipeline != nullptr && pass.pipeline->get() != VK_NULL_HANDLE, "a pass without a pipeline");
    const std::string name = "kernel " + pass.pipeline->name();
    require(pass.arguments.size() == pass.pipeline->push_bytes(),
            name + " takes " + std::to_string(pass.pipeline->push_bytes()) + " bytes of arguments and got " +
                std::to_string(pass.arguments.size()));
    require(std::max({pass.groups.x, pass.groups.y, pass.groups.z}) <= info.max_groups,
            name + " has more groups along an axis than the device's " + std::to_string(info.max_groups));
    check_bindings(pass, info);
    for (const auto* list : {&pass.reads, &pass.writes}) {
        for (const Buffer* buffer : *list) check_part(buffer, 0, 0, name);
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

// The handle names the bytes: one that comes again after its buffer's end can only cost a barrier, never miss
// one.
template <class Memory>  // a buffer or an image
Access access_to(const Memory* memory, Stage stage, Access::Kind kind) {
    return {reinterpret_cast<std::uint64_t>(memory->get()), stage, kind};
}

// Buffers that a step writes and that the host sees.
std::vector<const Buffer*> shown_by(const Step& step) {
    std::vector<const Buffer*> written =
        std::visit(Overloaded{[](const Pass& pass) { return pass.writes; },
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
    std::visit(Overloaded{[&](const Pass& pass) { check_pass(pass, info); },
                          [](const Copy& copy) {
                              check_part(copy.from, copy.from_offset, copy.bytes, "a copy");
                              check_part(copy.to, copy.to_offset, copy.bytes, "a copy");
                          },
                          [](const Fill& fill) {
                              check_part(fill.buffer, fill.offset, fill.bytes, "a fill");
                              require(fill.offset % 4 == 0 && fill.bytes % 4 == 0,
                                      "a fill that is not of whole words");
                          },
                          [&](const DrawList& list) { check_draws(list, info); },
                          [](const CopyImage& copy) { check_copy(copy); },
                          [](const Prepare& prepare) {
                              require(prepare.image != nullptr && prepare.image->get() != VK_NULL_HANDLE,
                                      "a preparation without an image");
                          },
                          [](const Publish&) {}},
               step);
}

std::vector<Access> accesses_of(const Step& step) {
    using enum Access::Kind;
    std::vector<Access> accesses;
    const auto add = [&](const auto* memory, Stage stage, Access::Kind kind) {
        accesses.push_back(access_to(memory, stage, kind));
    };
    std::visit(Overloaded{[&](const Pass& pass) {
                              for (const Buffer* buffer : pass.reads) add(buffer, Compute, Read);
                              for (const Buffer* buffer : pass.writes) add(buffer, Compute, Write);
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
                          [&](const Prepare& prepare) { add(prepare.image, Attachment, Write); },
                          [](const Publish&) {}},
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

void Recorder::publish() {
    memory_barrier(commands_,
                   {.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER_2,
                    .srcStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
                    .srcAccessMask = VK_ACCESS_2_MEMORY_WRITE_BIT,
                    .dstStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT | VK_PIPELINE_STAGE_2_HOST_BIT,
                    .dstAccessMask = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT |
                                     VK_ACCESS_2_HOST_READ_BIT});
    plan_.forget();
}

void Recorder::dispatch(const Pass& pass) {
    vkCmdBindPipeline(commands_, VK_PIPELINE_BIND_POINT_COMPUTE, pass.pipeline->get());
    const VkDescriptorSet set = make_set(device_, slot_.sets.get(), pass);
    if (set != VK_NULL_HANDLE) {
        vkCmdBindDescriptorSets(commands_, VK_PIPELINE_BIND_POINT_COMPUTE, pass.pipeline->layout(), 0, 1,
                                &set, 0, nullptr);
    }
    if (pass.arguments.size() > 0) {
        vkCmdPushConstants(commands_, pass.pipeline->layout(), VK_SHADER_STAGE_COMPUTE_BIT, 0,
                           pass.arguments.size(), pass.arguments.data());
    }
    vkCmdDispatch(commands_, pass.groups.x, pass.groups.y, pass.groups.z);
}

void Recorder::record(const Step& step) {
    if (const auto needed = plan_.before(accesses_of(step))) barrier(*needed);
    std::visit(Overloaded{[&](const Pass& pass) { dispatch(pass); },
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
                          [&](const Prepare& prepare) { record_preparation(commands_, *prepare.image); },
                          [&](const Publish&) { publish(); }},
               step);
    for (const Buffer* buffer : shown_by(step)) {
        for_host_.push_back(access_to(buffer, Host, Access::Kind::Read));
    }
}

void Recorder::timestamp() {
    vkCmdWriteTimestamp2(commands_, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, slot_.queries.get(), stamp_++);
}

void Recorder::show_host() {
    if (const auto needed = plan_.before(for_host_)) barrier(*needed);
}

}  // namespace tessera::vulkan
