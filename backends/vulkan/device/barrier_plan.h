#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <unordered_map>

namespace tessera::vulkan {

// Pipeline stages that access memory; masks are sums of these. Drawing: reads by the shaders of a draw;
// Attachment: colour and depth attachments.
enum Stage : std::uint32_t {
    Compute = 1,
    Transfer = 2,
    Indirect = 4,
    Host = 8,
    Drawing = 16,
    Attachment = 32
};
inline constexpr std::size_t StageCount = 6;
using StageMask = std::uint32_t;

struct Access {
    enum class Kind { Read, Write };  // read-write accesses count as writes
    std::uint64_t resource = 0;       // equal numbers denote the same bytes
    Stage stage = Compute;
    Kind kind = Kind::Read;
};

// Everything in `sources` finishes before anything in `destinations` starts; writes of `writers`, a subset of
// the sources, become visible there.
struct Barrier {
    StageMask sources = 0, writers = 0, destinations = 0;
};

// Derives barriers from the accesses of the steps of a queue, in order. A barrier is placed as late as possible
// and covers everything before it; among dispatches alone the number of barriers is minimal. Host reads need no
// barrier before later steps, since the host waits first. Independent of the device.
class BarrierPlan final {
  public:
    // The barrier required before a step with these accesses, if any.
    std::optional<Barrier> before(std::span<const Access> accesses);

    // Forgets all previous accesses: the caller inserts a full barrier here.
    void reset() { resources_.clear(); }
    std::size_t size() const { return resources_.size(); }  // tracked resources

  private:
    struct History {
        StageMask writer = 0;           // the last writing stage
        StageMask visible_to = 0;       // stages that see that write
        StageMask readers = 0;          // stages that have read since
        StageMask after[StageCount]{};  // per reading stage: stages ordered after its reads
    };
    Barrier needed(std::span<const Access> accesses) const;
    void apply(const Barrier& barrier);
    void record(std::span<const Access> accesses);

    std::unordered_map<std::uint64_t, History> resources_;
};

}  // namespace tessera::vulkan
