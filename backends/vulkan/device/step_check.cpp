#include "backends/vulkan/device/step_check.h"

#include "backends/vulkan/device/buffer.h"
#include "mediator/base/error.h"

namespace tessera::vulkan {

void require(bool holds, const std::string& what) {
    if (!holds) throw Error(ErrorCode::Internal, what + "; report this");
}

void check_range(const Buffer* buffer, std::uint64_t offset, std::uint64_t bytes, const std::string& step) {
    require(buffer != nullptr && buffer->get() != VK_NULL_HANDLE, step + " without a buffer");
    require(offset <= buffer->size() && bytes <= buffer->size() - offset,
            step + " beyond the end of a buffer of " + std::to_string(buffer->size()) + " bytes");
}

}  // namespace tessera::vulkan
