#include "backends/vulkan/device/barrier_plan.h"

#include <array>
#include <bit>

namespace tessera::vulkan {

namespace {

constexpr std::array<Stage, StageCount> Stages{Compute, Transfer, Indirect, Host, Drawing, Attachment};

std::size_t index(Stage stage) {
    return static_cast<std::size_t>(std::countr_zero(std::uint32_t(stage)));
}

}  // namespace

Barrier BarrierPlan::needed(std::span<const Access> accesses) const {
    Barrier barrier;
    for (const Access& access : accesses) {
        const auto found = resources_.find(access.resource);
        if (found == resources_.end()) continue;
        const History& history = found->second;
        if (history.writer != 0 && (history.visible_to & access.stage) == 0) {
            barrier.sources |= history.writer;
            barrier.destinations |= access.stage;
        }
        if (access.kind == Access::Kind::Read) continue;
        for (const Stage reader : Stages) {
            const bool is_open =
                (history.readers & reader) != 0 && (history.after[index(reader)] & access.stage) == 0;
            if (!is_open) continue;
            barrier.sources |= reader;
            barrier.destinations |= access.stage;
        }
    }
    // A required barrier makes all writes of these stages visible, so that later reads need no other one.
    for (const auto& [resource, history] : resources_) {
        const bool is_shown = (history.visible_to & barrier.destinations) == barrier.destinations;
        if (!is_shown) barrier.writers |= history.writer & barrier.sources;
    }
    return barrier;
}

void BarrierPlan::apply(const Barrier& barrier) {
    for (auto& [resource, history] : resources_) {
        if ((history.writer & barrier.writers) != 0) history.visible_to |= barrier.destinations;
        for (const Stage reader : Stages) {
            if ((history.readers & barrier.sources & reader) != 0) {
                history.after[index(reader)] |= barrier.destinations;
            }
        }
    }
}

void BarrierPlan::record(std::span<const Access> accesses) {
    for (const Access& access : accesses) {
        if (access.kind != Access::Kind::Read || access.stage == Host) continue;
        History& history = resources_[access.resource];
        history.readers |= access.stage;
        history.after[index(access.stage)] = 0;
    }
    for (const Access& access : accesses) {
        if (access.kind == Access::Kind::Write) resources_[access.resource] = {.writer = access.stage};
    }
}

std::optional<Barrier> BarrierPlan::before(std::span<const Access> accesses) {
    const Barrier barrier = needed(accesses);
    if (barrier.sources != 0) apply(barrier);
    record(accesses);
    return barrier.sources != 0 ? std::optional(barrier) : std::nullopt;
}

}  // namespace tessera::vulkan
