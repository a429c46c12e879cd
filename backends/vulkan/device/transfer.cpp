#include "backends/vulkan/device/transfer.h"

#include <algorithm>
#include <cstring>
#include <string>

namespace tessera::vulkan {

namespace {

constexpr std::uint64_t StagingBytes = 16u << 20;

void check_range(const Buffer& buffer, std::uint64_t offset, std::uint64_t bytes) {
    if (offset <= buffer.size() && bytes <= buffer.size() - offset) return;
    throw Error(ErrorCode::Internal, "a transfer of " + std::to_string(bytes) + " bytes beyond the end of " +
                                         std::to_string(buffer.size()) + "; report this");
}

}  // namespace

void upload_bytes(Device& device, const Buffer& buffer, std::span<const std::byte> bytes,
                  std::uint64_t offset) {
    check_range(buffer, offset, bytes.size());
    if (bytes.empty()) return;
    if (!buffer.mapped().empty()) {
        device.queue().wait_idle();
        std::memcpy(buffer.mapped().data() + offset, bytes.data(), bytes.size());
        return;
    }
    const Buffer staging(device, std::min<std::uint64_t>(bytes.size(), StagingBytes), MemoryKind::Upload);
    for (std::uint64_t at = 0; at < bytes.size(); at += staging.size()) {
        const std::uint64_t part = std::min<std::uint64_t>(bytes.size() - at, staging.size());
        std::memcpy(staging.mapped().data(), bytes.data() + at, part);
        device.queue().submit(Copy{&staging, &buffer, 0, offset + at, part}).wait();
    }
}

void download_bytes(Device& device, const Buffer& buffer, std::span<std::byte> bytes, std::uint64_t offset) {
    check_range(buffer, offset, bytes.size());
    if (bytes.empty()) return;
    if (!buffer.mapped().empty()) {
        device.queue().wait_idle();
        std::memcpy(bytes.data(), buffer.mapped().data() + offset, bytes.size());
        return;
    }
    const Buffer staging(device, std::min<std::uint64_t>(bytes.size(), StagingBytes), MemoryKind::Readback);
    for (std::uint64_t at = 0; at < bytes.size(); at += staging.size()) {
        const std::uint64_t part = std::min<std::uint64_t>(bytes.size() - at, staging.size());
        device.queue().submit(Copy{&buffer, &staging, offset + at, 0, part}).wait();
        std::memcpy(bytes.data() + at, staging.mapped().data(), part);
    }
}

}  // namespace tessera::vulkan
