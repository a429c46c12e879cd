#include "backends/vulkan/device_table.h"

#include <algorithm>

#include "backends/vulkan/device/transfer.h"

namespace tessera::vulkan {

void DeviceTable::update(std::span<const std::byte> bytes) {
    if (bytes.size() != content_.size() || buffer_.address() == 0) {
        content_.clear();
        buffer_ = Buffer(device_, std::max<std::size_t>(bytes.size(), 16));
        upload_bytes(device_, buffer_, bytes);
    } else {
        const auto first = std::ranges::mismatch(bytes, content_).in1 - bytes.begin();
        if (first == static_cast<std::ptrdiff_t>(bytes.size())) return;
        std::size_t end = bytes.size();
        while (bytes[end - 1] == content_[end - 1]) --end;
        // Copies are in units of 4-byte words.
        const std::size_t begin = static_cast<std::size_t>(first) / 4 * 4;
        const std::size_t words_end = std::min(bytes.size(), (end + 3) / 4 * 4);
        upload_bytes(device_, buffer_, bytes.subspan(begin, words_end - begin), begin);
    }
    content_.assign(bytes.begin(), bytes.end());
}

}  // namespace tessera::vulkan
