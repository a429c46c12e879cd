#include "mediator/display/warp.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mediator/display/planar_row.h"

namespace tessera::display {

namespace {

constexpr float NoSource = std::numeric_limits<float>::quiet_NaN();

}  // namespace

Warp::Warp(const DeviceGrid& points, const Output& output)
    : points_(points),
      width_(output.width),
      stride_(padded(output.width)),
      margin_u_(0.5 / output.view_width),
      margin_v_(0.5 / output.view_height),
      u_(stride_ * output.height, NoSource),
      v_(stride_ * output.height, NoSource),
      is_made_(output.height, 0) {}

void Warp::set_frustum(const view::CameraPose& in_display) {
    if (in_display == camera_) return;
    camera_ = in_display;
    std::fill(is_made_.begin(), is_made_.end(), std::uint8_t{0});
}

Warp::Row Warp::row(std::size_t y, std::span<float> space) {
    if (is_made_[y] == 0) {
        make_row(y, space);
        is_made_[y] = 1;
    }
    return {u_.data() + y * stride_, v_.data() + y * stride_};
}

void Warp::make_row(std::size_t y, std::span<float> space) {
    float* const at = space.data();
    for (std::size_t c = 0; c < 3; ++c) points_.row(c, y, at + c * width_, at + 3 * width_);
    const glm::dvec3 right(camera_.world_from_camera[0]), up(camera_.world_from_camera[1]),
        back(camera_.world_from_camera[2]), eye(camera_.world_from_camera[3]);
    // u and v of a direction are its components along these two, divided by that along the third: its depth.
    const glm::dvec3 along_u = (right + camera_.left * back) / (camera_.right - camera_.left);
    const glm::dvec3 along_v = -(up + camera_.top * back) / (camera_.top - camera_.bottom);
    float *const u = u_.data() + y * stride_, *const v = v_.data() + y * stride_;
    const float *const px = at, *const py = at + width_, *const pz = at + 2 * width_;
    for (std::size_t x = 0; x < width_; ++x) {
        const double dx = px[x] - eye.x, dy = py[x] - eye.y, dz = pz[x] - eye.z;
        const double depth = -(back.x * dx + back.y * dy + back.z * dz);
        const double at_u = (along_u.x * dx + along_u.y * dy + along_u.z * dz) / depth;
        const double at_v = (along_v.x * dx + along_v.y * dy + along_v.z * dz) / depth;
        const double in_u = std::min(std::max(at_u, 0.0), 1.0), in_v = std::min(std::max(at_v, 0.0), 1.0);
        // NaN: not visible.
        const bool is_there =
            depth > 0.0 && std::abs(at_u - in_u) <= margin_u_ && std::abs(at_v - in_v) <= margin_v_;
        u[x] = is_there ? static_cast<float>(in_u) : NoSource;
        v[x] = is_there ? static_cast<float>(in_v) : NoSource;
    }
}

}  // namespace tessera::display
