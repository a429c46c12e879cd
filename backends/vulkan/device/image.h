#pragma once

#include <vulkan/vulkan_core.h>

#include <cstdint>
#include <memory>

namespace tessera::vulkan {

class Device;

// A picture on the device that draws go to and that copies read. Its end never waits, like a buffer's; the
// device outlives it. It stays in one layout for good, so that barriers of memory are all that orders its
// uses.
class Image final {
  public:
    enum class Kind {
        Ids,   // two 32-bit numbers a pixel
        Depth  // one 32-bit float a pixel
    };

    Image() = default;  // of no pixels
    // Contents undefined. Throws Error{OutOfMemory} with the sizes, Error{Internal} for edges that are 0 or
    // beyond the device's, and DeviceLost.
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
