#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>
#include <vector>

#include "backends/vulkan/device/buffer.h"
#include "backends/vulkan/device/device.h"

namespace tessera::vulkan {

// Both are ordered against everything submitted before and after, and are done when they return; they use
// staging memory if the buffer is not host-visible. They throw DeviceLost, or Error{Internal} for a range beyond
// the end of the buffer.
void upload_bytes(Device& device, const Buffer& buffer, std::span<const std::byte> bytes,
                  std::uint64_t offset = 0);
void download_bytes(Device& device, const Buffer& buffer, std::span<std::byte> bytes,
                    std::uint64_t offset = 0);

// For a buffer that no step has used yet, so that no wait is needed: up to a few MiB, the copy to a buffer that is
// not host-visible is still in flight when this returns. Later submissions see the bytes.
void fill_new_bytes(Device& device, const Buffer& buffer, std::span<const std::byte> bytes);

// An asynchronous download of a range of a buffer, after everything submitted before. Other submissions may
// follow. The bytes are valid for the lifetime of this object, unless the range is written again.
class Download final {
  public:
    Download() = default;  // empty
    Download(Device& device, const Buffer& from, std::uint64_t offset, std::uint64_t bytes);

    bool done() const { return submission_.done(); }
    std::span<const std::byte> wait() const;  // throws DeviceLost

  private:
    Buffer staging_;  // only if the buffer is not host-visible
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

// Submits a dispatch and waits for it.
inline void run(Device& device, const Dispatch& dispatch) {
    device.queue().submit(Step(dispatch)).wait();
}

}  // namespace tessera::vulkan
