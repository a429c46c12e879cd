#pragma once

#include <vulkan/vulkan_core.h>

#include <cstdint>
#include <memory>

namespace tessera::vulkan {

class Device;

// An image on the device that draws write and copies read. Destruction never waits, as for buffers; the device
// outlives it. It stays in one layout, so that memory barriers are sufficient.
class Image final {
  public:
    enum class Kind {
        Ids,   // two 32-bit integers per pixel
        Depth  // one 32-bit float per pixel
    };

    Image() = default;  // empty
    // Contents are undefined. Throws Error{OutOfMemory} with the sizes, Error{Internal} for a size of 0 or beyond
    // the device's limit, and DeviceLost.
    Image(Device& device, Kind kind, std::uint32_t width, std::uint32_t height);
    Image(Image&& other) noexcept;
    Image& operator=(Image&& other) noexcept;
    ~Image();

    Kind kind() const { return kind_; }
    std::uint32_t width() const { return width_; }
    std::uint32_t height() const { return height_; }
    VkImage get() const;
    VkImageView view() const;
    VkImageAspectFlags aspect() const;
    std::uint32_t pixel_bytes() const { return kind_ == Kind::Ids ? 8 : 4; }

    static VkFormat format(Kind kind);

  private:
    struct Parts;
    Device* device_ = nullptr;
    std::shared_ptr<Parts> parts_;
    Kind kind_ = Kind::Ids;
    std::uint32_t width_ = 0, height_ = 0;
};

}  // namespace tessera::vulkan
