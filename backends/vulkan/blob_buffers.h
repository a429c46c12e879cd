#pragma once

#include <map>

#include "backends/vulkan/device/buffer.h"
#include "mediator/scene/blob.h"

namespace tessera::vulkan {

// The blobs that a scene's records point into, each once on the device.
class BlobBuffers final {
  public:
    explicit BlobBuffers(Device& device) : device_(device) {}

    // Where the blob lies, sent there if it is new. Throws Error{OutOfMemory} with the sizes.
    std::uint64_t address_of(const scene::BlobPtr& blob);
    // Between two calls of it, what nobody asked for is dropped.
    void drop_unused();

  private:
    struct Entry {
        Buffer buffer;
        bool used = false;
    };
    Device& device_;
    std::map<Hash256, Entry> entries_;
};

}  // namespace tessera::vulkan
