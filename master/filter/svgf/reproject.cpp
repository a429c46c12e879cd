#include "master/filter/svgf/reproject.h"

#include <array>
#include <glm/gtc/matrix_inverse.hpp>
#include <glm/mat4x4.hpp>

namespace tessera::filter::svgf {

namespace {

constexpr float Unseen = -1e6f;
constexpr float LeastWeight = 0.01f;  // of the four taps together

// The change of the normal per pixel, of both sides the smaller one.
float normal_change(const Planes& normal, std::uint32_t x, std::uint32_t y) {
    const auto change = [&](std::int64_t dx, std::int64_t dy) {
        const std::int64_t ax = x + dx, ay = y + dy;
        if (ax < 0 || ay < 0 || ax >= normal.width() || ay >= normal.height()) return 2.0f;
        float square = 0.0f;
        for (std::uint32_t c = 0; c < 3; ++c) {
            const float d = normal.row(c, static_cast<std::uint32_t>(ay))[ax] - normal.row(c, y)[x];
            square += d * d;
        }
        return std::sqrt(square);
    };
    return std::min(change(-1, 0), change(1, 0)) + std::min(change(0, -1), change(0, 1));
}

}  // namespace

bool find_motion(const Guides& now, const Guides& before, Motion& motion, RunContext& context) {
    const std::uint32_t width = now.inverse_depth.width(), height = now.inverse_depth.height();
    if (motion.position.width() != width || motion.position.height() != height) {
        motion.position = Planes(width, height, 2);
        motion.inverse_depth = Planes(width, height, 1);
    }
    const view::CameraPose &a = now.camera, &b = before.camera;
    motion.identity = a == b;
    // Rigid: the inverse is exact enough in double, and what is left is small, however far the origin is.
    const glm::dmat4 relative = glm::affineInverse(b.world_from_camera) * a.world_from_camera;
    const glm::mat3 turn(relative);
    const glm::vec3 shift(relative[3]);
    const auto to_pixel_x = static_cast<float>(width / (b.right - b.left));
    const auto to_pixel_y = static_cast<float>(height / (b.bottom - b.top));
    const auto left = static_cast<float>(b.left), top = static_cast<float>(b.top);
    return for_rows(context, height, [&](std::uint32_t y) {
        const float* inverse = now.inverse_depth.row(0, y);
        float* __restrict to_x = motion.position.row(0, y);
        float* __restrict to_y = motion.position.row(1, y);
        float* __restrict to_inverse = motion.inverse_depth.row(0, y);
        if (motion.identity) {
            for (std::uint32_t x = 0; x < width; ++x) {
                to_x[x] = static_cast<float>(x);
                to_y[x] = static_cast<float>(y);
                to_inverse[x] = inverse[x];
            }
            return;
        }
        const auto py = static_cast<float>(a.top + (a.bottom - a.top) * (y + 0.5) / height);
        const auto px0 = static_cast<float>(a.left + (a.right - a.left) * 0.5 / width);
        const auto step = static_cast<float>((a.right - a.left) / width);
        for (std::uint32_t x = 0; x < width; ++x) {
            // The point divided by its depth, so that infinite depth is nothing special.
            const float px = px0 + step * static_cast<float>(static_cast<std::int32_t>(x));
            const float qx = turn[0].x * px + turn[1].x * py - turn[2].x + shift.x * inverse[x];
            const float qy = turn[0].y * px + turn[1].y * py - turn[2].y + shift.y * inverse[x];
            const float qz = turn[0].z * px + turn[1].z * py - turn[2].z + shift.z * inverse[x];
            const bool in_front = qz < -1e-6f;
            const float scale = in_front ? -1.0f / qz : 0.0f;
            to_x[x] = in_front ? (qx * scale - left) * to_pixel_x - 0.5f : Unseen;
            to_y[x] = in_front ? (qy * scale - top) * to_pixel_y - 0.5f : Unseen;
            to_inverse[x] = inverse[x] * scale;
        }
    });
}

bool reproject(const Guides& now, const Guides& before, const Motion& motion, const SurfaceTests& tests,
               std::span<const HistoryView> from, Planes& to, RunContext& context) {
    const std::uint32_t width = now.inverse_depth.width(), height = now.inverse_depth.height();
    const auto components = static_cast<std::uint32_t>(from.size());
    if (to.width() != width || to.height() != height || to.components() != components) {
        to = Planes(width, height, components);
    }
    const HistoryView ages = from.back();
    return for_rows(context, height, [&](std::uint32_t y) {
        for (std::uint32_t x = 0; x < width; ++x) {
            const std::size_t i = std::size_t{y} * width + x;
            const float expected = motion.inverse_depth.plane(0)[i];
            const float tolerance =
                tests.depth * expected +
                tests.depth_slopes * (std::fabs(now.slope.plane(0)[i]) + std::fabs(now.slope.plane(1)[i]));
            const float turned =
                now.ids[i] == 0 ? 0.0f : tests.normal_slopes * (normal_change(now.normal, x, y) + 0.01f);
            const auto valid = [&](std::int64_t tx, std::int64_t ty) {
                if (tx < 0 || ty < 0 || tx >= width || ty >= height) return false;
                const auto j = static_cast<std::size_t>(ty) * width + static_cast<std::size_t>(tx);
                if (before.ids[j] != now.ids[i]) return false;
                if (std::fabs(before.inverse_depth.plane(0)[j] - expected) > tolerance) return false;
                float square = 0.0f;
                for (std::uint32_t c = 0; c < 3; ++c) {
                    const float d = before.normal.plane(c)[j] - now.normal.plane(c)[i];
                    square += d * d;
                }
                return square <= turned * turned;
            };
            const auto at = [&](const HistoryView& view, std::int64_t tx, std::int64_t ty) {
                return view.values[static_cast<std::size_t>(ty) * view.pitch + static_cast<std::size_t>(tx)];
            };
            const auto clear = [&] {
                for (std::uint32_t c = 0; c < components; ++c) to.plane(c)[i] = 0.0f;
            };
            const float px = motion.position.plane(0)[i], py = motion.position.plane(1)[i];
            if (!(px > -2.0f && py > -2.0f && px < static_cast<float>(width) + 1.0f &&
                  py < static_cast<float>(height) + 1.0f)) {
                clear();
                continue;
            }
            const auto x0 = static_cast<std::int64_t>(std::floor(px));
            const auto y0 = static_cast<std::int64_t>(std::floor(py));
            const float fx = px - static_cast<float>(x0), fy = py - static_cast<float>(y0);
            std::array<float, 4> weights;
            float same = 0.0f, sum = 0.0f;  // of the taps on this surface; of those that know something
            for (int t = 0; t < 4; ++t) {
                const float w = (t % 2 ? fx : 1.0f - fx) * (t / 2 ? fy : 1.0f - fy);
                const bool passes = w > 0.0f && valid(x0 + t % 2, y0 + t / 2);
                const bool known = passes && at(ages, x0 + t % 2, y0 + t / 2) > 0.0f;
                weights[static_cast<std::size_t>(t)] = known ? w : 0.0f;
                same += passes ? w : 0.0f;
                sum += weights[static_cast<std::size_t>(t)];
            }
            if (sum >= LeastWeight) {
                for (std::uint32_t c = 0; c < components; ++c) {
                    float value = 0.0f;
                    for (int t = 0; t < 4; ++t) {
                        const float w = weights[static_cast<std::size_t>(t)];
                        if (w > 0.0f) value += w * at(from[c], x0 + t % 2, y0 + t / 2);
                    }
                    to.plane(c)[i] = value / sum;
                }
                continue;
            }
            // Neighbours stand in for a surface that was missed, not for one that is known to be unknown.
            if (same >= LeastWeight || motion.identity) {
                clear();
                continue;
            }
            const auto near_x = static_cast<std::int64_t>(std::lround(px));
            const auto near_y = static_cast<std::int64_t>(std::lround(py));
            clear();
            float found = 0.0f;
            for (std::int64_t ty = near_y - 1; ty <= near_y + 1; ++ty) {
                for (std::int64_t tx = near_x - 1; tx <= near_x + 1; ++tx) {
                    if (!valid(tx, ty) || !(at(ages, tx, ty) > 0.0f)) continue;
                    found += 1.0f;
                    for (std::uint32_t c = 0; c < components; ++c) to.plane(c)[i] += at(from[c], tx, ty);
                }
            }
            for (std::uint32_t c = 0; c < components && found > 1.0f; ++c) to.plane(c)[i] /= found;
        }
    });
}

}  // namespace tessera::filter::svgf
