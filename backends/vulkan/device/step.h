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
// (scalar layout). Addresses of buffers go in here.
class Arguments final {
  public:
    static constexpr std::size_t Capacity = 128;  // what every device allows

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

// One dispatch, and what it touches. The order between steps comes from `reads` and `writes` alone: name
// every buffer that the kernel reads or writes and that any step writes. Buffers that only upload() fills
// need not be named. A buffer that is read and written stands in `writes`.
struct Pass {
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

// Sets every 32-bit word of a part; offset and bytes are multiples of 4.
struct Fill {
    const Buffer* buffer = nullptr;
    std::uint64_t offset = 0, bytes = 0;
    std::uint32_t word = 0;
};

// All before is done and seen before anything after starts, named or not.
struct Publish {};

// A list of draws to a part of images, which begins with no ids there: 0xffffffff and 0. The order between
// steps comes from the images, the list and `reads`, as for a pass.
struct DrawList {
    const GraphicsPipeline* pipeline = nullptr;
    Arguments arguments;
    const Image* ids = nullptr;
    const Image* depth = nullptr;
    enum class Depth { Clear, Keep } depth_before = Depth::Clear;  // cleared: infinitely far, 0
    Rect area;                   // of the images; nothing outside of it is touched
    std::uint32_t viewport = 0;  // edge of a square whose corner is the images'; may be larger than they
    // `count` of VkDrawIndirectCommand from the buffer's start. One call makes up to `per_call` of them, at
    // most DeviceInfo::draws_per_call; where that is 1, no draw has another first instance than 0.
    const Buffer* draws = nullptr;
    std::uint32_t count = 0, per_call = 1;
    std::vector<const Buffer*> reads;
};

// A part of an image to a buffer, row after row; the offset is a multiple of a pixel's bytes.
struct CopyImage {
    const Image* from = nullptr;
    Rect area;
    const Buffer* to = nullptr;
    std::uint64_t to_offset = 0;
    std::uint32_t row_pixels = 0;  // from row to row in the buffer; 0: without gaps
};

// The image's contents are gone; only now it can be used. Images do this themselves when they are made.
struct Prepare {
    const Image* image = nullptr;
};

using Step = std::variant<Pass, Copy, Fill, Publish, DrawList, CopyImage, Prepare>;

}  // namespace tessera::vulkan
