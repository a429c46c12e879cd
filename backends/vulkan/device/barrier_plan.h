#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <unordered_map>

namespace tessera::vulkan {

// Who touches memory. Masks of stages are sums of these. Drawing is what the shaders of a draw read;
// Attachment is what its results go to and are compared with.
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
    enum class Kind { Read, Write };  // what reads and writes, writes
    std::uint64_t resource = 0;       // equal numbers: the same bytes
    Stage stage = Compute;
    Kind kind = Kind::Read;
};

// Everything of `sources` is done before anything of `destinations` starts; what `writers`, a part of the
// sources, wrote is seen there.
struct Barrier {
    StageMask sources = 0, writers = 0, destinations = 0;
};

// Derives barriers from what each step of a queue touches, in order. A barrier comes as late as it can and
// holds for everything before it; so among dispatches alone no plan has fewer. What the host reads, it reads
// after it waited: nothing is held back for it. Knows no device.
class BarrierPlan final {
  public:
    // The barrier that has to stand before a step with these accesses, if any.
    std::optional<Barrier> before(std::span<const Access> accesses);

    // From now on nothing is known of what was before: a barrier of everything has to stand here.
    void forget() { resources_.clear(); }
    std::size_t size() const { return resources_.size(); }  // resources it knows of

  private:
    struct History {
        StageMask writer = 0;           // the stage that wrote last
        StageMask seen = 0;             // where that is visible
        StageMask readers = 0;          // stages that read since
        StageMask after[StageCount]{};  // per reading stage: what comes after its reads
    };
    Barrier needed(std::span<const Access> accesses) const;
    void pass(const Barrier& barrier);
    void note(std::span<const Access> accesses);

    std::unordered_map<std::uint64_t, History> resources_;
};

}  // namespace tessera::vulkan
