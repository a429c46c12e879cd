#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>
#include <vector>

#include "backends/vulkan/device/buffer.h"
#include "backends/vulkan/device/device.h"

namespace tessera::vulkan {

// These two are ordered against everything submitted before and after, and done when they return; where the
// host does not see the buffer they go through staging memory. They throw DeviceLost, or Error{Internal} for
// a part beyond the buffer's end.
void upload_bytes(Device& device, const Buffer& buffer, std::span<const std::byte> bytes,
                  std::uint64_t offset = 0);
void download_bytes(Device& device, const Buffer& buffer, std::span<std::byte> bytes,
                    std::uint64_t offset = 0);

// For a buffer that no step knows yet, so that nothing has to be waited for: where the host does not see it,
// and for no more than a few MiB, the bytes are still on their way when this returns. What is submitted
// afterwards sees them.
void fill_new_bytes(Device& device, const Buffer& buffer, std::span<const std::byte> bytes);

// A part of a buffer on its way to the host, behind all that was submitted before; others may go on
// submitting. What it shows stays as long as it lives and the part is not written again.
class Download final {
  public:
    Download() = default;  // of nothing
    Download(Device& device, const Buffer& from, std::uint64_t offset, std::uint64_t bytes);

    bool done() const { return submission_.done(); }
    std::span<const std::byte> wait() const;  // throws DeviceLost

  private:
    Buffer staging_;  // only where the host does not see the buffer
    Submission submission_;
    std::span<const std::byte> bytes_;
};

template <class T>
requires std::is_trivially_copyable_v<T>
void upload(Device& device, const Buffer& buffer, const std::vector<T>& values) {
    upload_bytes(device, buffer, std::as_bytes(std::span(values)));
}

template <class T>
requires std::is_trivially_copyable_v<T> Buffer make_buffer(Device& device, const std::vector<T>& values) {
    Buffer buffer(device, values.size() * sizeof(T));
    fill_new_bytes(device, buffer, std::as_bytes(std::span(values)));
    return buffer;
}

template <class T>
requires std::is_trivially_copyable_v<T> std::vector<T> download(Device& device, const Buffer& buffer) {
    std::vector<T> values(buffer.size() / sizeof(T));
    download_bytes(device, buffer, std::as_writable_bytes(std::span(values)));
    return values;
}

// Submits a pass and waits: for tests and for what runs once.
inline void run(Device& device, const Pass& pass) {
    device.queue().submit(Step(pass)).wait();
}

}  // namespace tessera::vulkan
