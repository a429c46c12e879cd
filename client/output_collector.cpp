#include "client/output_collector.h"

#include <algorithm>
#include <cmath>

namespace tessera::client {

namespace {

bool is_finite(const view::CameraPose& camera) {
    bool finite = std::isfinite(camera.left) && std::isfinite(camera.right) && std::isfinite(camera.bottom) &&
                  std::isfinite(camera.top);
    for (int i = 0; i < 16; ++i) finite = finite && std::isfinite(camera.world_from_camera[i / 4][i % 4]);
    return finite && camera.right > camera.left && camera.top > camera.bottom;
}

}  // namespace

Expected<std::optional<OutputFrame>> OutputCollector::add(wire::OutputPicture&& piece) {
    if (!is_finite(piece.camera))
        return failure(ErrorCode::InvalidInput, "the master sent a picture without a camera");
    // After a break of the connection a frame may come again from its beginning.
    const bool again = frame_ && piece.offset == 0 &&
                       std::any_of(frame_->pictures.begin(), frame_->pictures.end(),
                                   [&](const auto& picture) { return picture.eye == piece.eye; });
    if (!frame_ || frame_->number != piece.frame || again) {
        frame_.reset();
        const bool is_first = piece.offset == 0 && (piece.eyes == 1 || piece.eye == view::Eye::Left);
        if (!is_first) return std::nullopt;  // its beginning was lost
        frame_ = OutputFrame{piece.frame, piece.version, piece.samples, {}};
        missing_ = 0;
    }
    if (piece.offset == 0) {
        if (missing_ != 0 || frame_->pictures.size() >= piece.eyes)
            return failure(ErrorCode::InvalidInput, "the master sent other pictures than it said");
        frame_->pictures.push_back({piece.eye, piece.camera, piece.width, piece.height, piece.encoding, {}});
        frame_->pictures.back().bytes.reserve(piece.total);
        missing_ = piece.total;
    }
    OutputFrame::Picture& picture = frame_->pictures.back();
    if (picture.eye != piece.eye || picture.bytes.size() != piece.offset || piece.data.size() > missing_)
        return failure(ErrorCode::InvalidInput, "the master sent pieces of a picture out of order");
    picture.bytes.insert(picture.bytes.end(), piece.data.begin(), piece.data.end());
    missing_ -= piece.data.size();
    if (missing_ != 0 || frame_->pictures.size() < piece.eyes) return std::nullopt;
    return std::exchange(frame_, std::nullopt);
}

}  // namespace tessera::client
