#include "client/picture_collector.h"

namespace tessera::client {

namespace {
constexpr std::uint64_t MaxBytes = std::uint64_t{1}
                                   << 33;  // 2^28 pixels of four floats and room for a header
}

Expected<void> PictureCollector::add(wire::PictureChunk&& chunk) {
    if (chunk.job != job_) return {};
    if (chunk.offset != bytes_.size() || chunk.total > MaxBytes) {
        return failure(
            ErrorCode::InvalidInput,
            "the master sent a picture with a gap: check that master and client are of the same version");
    }
    bytes_.insert(bytes_.end(), chunk.data.begin(), chunk.data.end());
    return {};
}

}  // namespace tessera::client
