#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>
#include <variant>
#include <vector>

#include "mediator/base/rect.h"

namespace tessera::vulkan {

class Buffer;
class ComputePipeline;
class GraphicsPipeline;
class Image;

// The push-constant block of one dispatch: any plain struct of at most 128 bytes, laid out as the shader's
// (scalar layout). Contains addresses of buffers.
class Arguments final {
  public:
    static constexpr std::size_t Capacity = 128;  // guaranteed on every device

    Arguments() = default;
    template <class T>
    requires(std::is_trivially_copyable_v<T> && sizeof(T) <= Capacity) Arguments(const T& block)
        : size_(sizeof(T)) {  // implicit: .arguments = Block{...}
        std::memcpy(bytes_.data(), &block, sizeof(T));
    }

    const std::byte* data() const { return bytes_.data(); }
    std::uint32_t size() const { return size_; }

  private:
    std::array<std::byte, Capacity> bytes_{};
    std::uint32_t size_ = 0;
};

struct Groups {
    std::uint32_t x = 1, y = 1, z = 1;
};

// One dispatch and its accesses. Barriers are derived from `reads` and `writes` alone: list every buffer that the
// kernel accesses and that any step writes. Buffers filled only by upload() need not be listed. Buffers that are
// read and written belong in `writes`.
struct Dispatch {
    const ComputePipeline* pipeline = nullptr;
    Arguments arguments;
    Groups groups;
    std::vector<const Buffer*> bound;  // for the pipeline's bindings, in their order
    std::vector<const Buffer*> reads, writes;
};

struct Copy {
    const Buffer* from = nullptr;
    const Buffer* to = nullptr;
    std::uint64_t from_offset = 0, to_offset = 0, bytes = 0;
};

// Sets every 32-bit word of a range; offset and bytes are multiples of 4.
struct Fill {
    const Buffer* buffer = nullptr;
    std::uint64_t offset = 0, bytes = 0;
    std::uint32_t word = 0;
};

// A full memory barrier, also for buffers that steps do not list.
struct FullBarrier {};

// Draws to an area of images, whose ids are cleared to 0xffffffff and 0 first. Barriers are derived from the
// images, the list and `reads`, as for a dispatch.
struct DrawList {
    const GraphicsPipeline* pipeline = nullptr;
    Arguments arguments;
    const Image* ids = nullptr;
    const Image* depth = nullptr;
    enum class Depth { Clear, Keep } depth_before = Depth::Clear;  // clears to 0, infinitely far
    Rect area;                   // of the images; nothing outside of it is modified
    std::uint32_t viewport = 0;  // edge of a square at the images' corner; may be larger than the images
    // `count` VkDrawIndirectCommand from the start of the buffer. One call issues up to `per_call` of them, at
    // most DeviceInfo::draws_per_call; if that is 1, the first instance of all draws must be 0.
    const Buffer* draws = nullptr;
    std::uint32_t count = 0, per_call = 1;
    std::vector<const Buffer*> reads;
};

// Copies an area of an image to a buffer, row by row; the offset is a multiple of the pixel size.
struct CopyImage {
    const Image* from = nullptr;
    Rect area;
    const Buffer* to = nullptr;
    std::uint64_t to_offset = 0;
    std::uint32_t row_pixels = 0;  // row pitch in the buffer; 0: tightly packed
};

// Transitions a new image to its layout, discarding its contents. Images do this in their constructor.
struct InitializeImage {
    const Image* image = nullptr;
};

using Step = std::variant<Dispatch, Copy, Fill, FullBarrier, DrawList, CopyImage, InitializeImage>;

}  // namespace tessera::vulkan
