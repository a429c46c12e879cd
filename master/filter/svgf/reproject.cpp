#include "master/filter/svgf/reproject.h"

#include <algorithm>
#include <array>
#include <glm/gtc/matrix_inverse.hpp>
#include <glm/mat4x4.hpp>

namespace tessera::filter::svgf {

namespace {

constexpr float Unseen = -1e6f;
constexpr float LeastWeight = 0.01f;  // of the four taps together

// The change of the normal per pixel, the smaller one of both sides.
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
    const bool is_parallel =
        a.projection == scene::Projection::Orthographic || b.projection == scene::Projection::Orthographic;
    // Rigid transforms: the inverse is precise enough in double, and the relative motion is small even far
    // from the origin.
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
        if (is_parallel) {  // the formulas below do not hold: the history restarts
            std::fill_n(to_x, width, Unseen);
            std::fill_n(to_y, width, Unseen);
            std::copy_n(inverse, width, to_inverse);
            return;
        }
        const auto py = static_cast<float>(a.top + (a.bottom - a.top) * (y + 0.5) / height);
        const auto px0 = static_cast<float>(a.left + (a.right - a.left) * 0.5 / width);
        const auto step = static_cast<float>((a.right - a.left) / width);
        for (std::uint32_t x = 0; x < width; ++x) {
            // The point divided by its depth, so that infinite depth needs no special case.
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

namespace {

// The tests of one pixel against pixels of the previous picture. Raw pointers, since this is the only loop of
// the filter that cannot be vectorised.
class SurfaceTest {
  public:
    SurfaceTest(const Guides& now, const Guides& before, const SurfaceTests& tests)
        : now_(now),
          before_ids_(before.ids.data()),
          before_inverse_(before.inverse_depth.plane(0).data()),
          before_normal_(before.normal.plane(0).data()),
          pixels_(before.inverse_depth.pixel_count()),
          tests_(tests) {}

    void set_pixel(std::uint32_t x, std::uint32_t y, float expected) {
        x_ = x;
        y_ = y;
        const std::size_t i = std::size_t{y} * now_.inverse_depth.width() + x;
        id_ = now_.ids[i];
        expected_ = expected;
        tolerance_ = tests_.depth * expected + tests_.depth_slopes * (std::fabs(now_.slope.plane(0)[i]) +
                                                                      std::fabs(now_.slope.plane(1)[i]));
        for (std::uint32_t c = 0; c < 3; ++c) normal_[c] = now_.normal.plane(c)[i];
        turn_ = -1.0f;
    }

    bool passes(std::size_t j) {
        if (before_ids_[j] != id_ || !(std::fabs(before_inverse_[j] - expected_) <= tolerance_)) return false;
        float square = 0.0f;
        for (std::size_t c = 0; c < 3; ++c) {
            const float d = before_normal_[c * pixels_ + j] - normal_[c];
            square += d * d;
        }
        const float least = tests_.normal_slopes * 0.01f;
        if (square <= least * least) return true;
        // Computed on demand, since it is rarely needed.
        if (turn_ < 0.0f) turn_ = least + tests_.normal_slopes * normal_change(now_.normal, x_, y_);
        return square <= turn_ * turn_;
    }

  private:
    const Guides& now_;
    const std::uint32_t* before_ids_;
    const float *before_inverse_, *before_normal_;
    std::size_t pixels_;
    SurfaceTests tests_;
    std::uint32_t x_ = 0, y_ = 0, id_ = 0;
    float expected_ = 0.0f, tolerance_ = 0.0f, turn_ = -1.0f;
    std::array<float, 3> normal_{};
};

// The history at one pixel of the new picture.
class Lookup {
  public:
    Lookup(const Guides& now, const Guides& before, const SurfaceTests& tests,
           std::span<const HistoryView> from)
        : test_(now, before, tests),
          from_(from),
          width_(static_cast<std::int32_t>(now.inverse_depth.width())),
          height_(static_cast<std::int32_t>(now.inverse_depth.height())) {}

    bool may_reach(float px, float py) const {
        return px > -2.0f && py > -2.0f && px < static_cast<float>(width_ + 1) &&
               py < static_cast<float>(height_ + 1);
    }
    void set_pixel(std::uint32_t x, std::uint32_t y, float expected) { test_.set_pixel(x, y, expected); }

    enum class Found { History, SurfaceAlone, Nothing };
    // Of the four pixels around (px, py), by bilinear weights of those that show the same surface.
    Found interpolate(float px, float py, std::uint32_t x, std::uint32_t y, Planes& to) {
        const auto x0 = static_cast<std::int32_t>(px + 2.0f) - 2,
                   y0 = static_cast<std::int32_t>(py + 2.0f) - 2;
        const float fx = px - static_cast<float>(x0), fy = py - static_cast<float>(y0);
        std::array<float, 4> weights{(1.0f - fx) * (1.0f - fy), fx * (1.0f - fy), (1.0f - fx) * fy, fx * fy};
        float same = 0.0f, sum = 0.0f;  // of the taps on this surface; of those with history
        for (std::int32_t t = 0; t < 4; ++t) {
            float& weight = weights[static_cast<std::size_t>(t)];
            const bool on_surface = weight > 0.0f && passes(x0 + t % 2, y0 + t / 2);
            same += on_surface ? weight : 0.0f;
            if (!on_surface || !knows(x0 + t % 2, y0 + t / 2)) weight = 0.0f;
            sum += weight;
        }
        if (!(sum >= LeastWeight)) return same >= LeastWeight ? Found::SurfaceAlone : Found::Nothing;
        // A tap without weight may be outside: it reads the pixel of another tap.
        std::array<std::int32_t, 4> tx, ty;
        std::size_t some = 0;
        while (weights[some] == 0.0f) ++some;
        for (std::size_t t = 0; t < 4; ++t) {
            const auto used = static_cast<std::int32_t>(weights[t] > 0.0f ? t : some);
            tx[t] = x0 + used % 2;
            ty[t] = y0 + used / 2;
            weights[t] /= sum;
        }
        for (std::uint32_t c = 0; c < from_.size(); ++c) {
            const HistoryView& view = from_[c];
            to.row(c, y)[x] = (weights[0] * at(view, tx[0], ty[0]) + weights[1] * at(view, tx[1], ty[1])) +
                              (weights[2] * at(view, tx[2], ty[2]) + weights[3] * at(view, tx[3], ty[3]));
        }
        return Found::History;
    }

    // The mean of the pixels around (px, py) that show the same surface.
    void average_around(float px, float py, std::uint32_t x, std::uint32_t y, Planes& to) {
        const auto near_x = static_cast<std::int32_t>(px + 2.5f) - 2;
        const auto near_y = static_cast<std::int32_t>(py + 2.5f) - 2;
        float found = 0.0f;
        for (std::int32_t ty = near_y - 1; ty <= near_y + 1; ++ty) {
            for (std::int32_t tx = near_x - 1; tx <= near_x + 1; ++tx) {
                if (!passes(tx, ty) || !knows(tx, ty)) continue;
                found += 1.0f;
                for (std::uint32_t c = 0; c < from_.size(); ++c) to.row(c, y)[x] += at(from_[c], tx, ty);
            }
        }
        for (std::uint32_t c = 0; c < from_.size() && found > 1.0f; ++c) to.row(c, y)[x] /= found;
    }

  private:
    static float at(const HistoryView& view, std::int32_t x, std::int32_t y) {
        return view.values[static_cast<std::ptrdiff_t>(y) * static_cast<std::ptrdiff_t>(view.pitch) + x];
    }
    bool passes(std::int32_t x, std::int32_t y) {
        return x >= 0 && y >= 0 && x < width_ && y < height_ &&
               test_.passes(static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
                            static_cast<std::size_t>(x));
    }
    bool knows(std::int32_t x, std::int32_t y) const { return at(from_.back(), x, y) > 0.0f; }  // its age

    SurfaceTest test_;
    std::span<const HistoryView> from_;
    std::int32_t width_, height_;
};

}  // namespace

namespace {

bool shows(const std::vector<std::uint32_t>& ids, std::uint32_t width, std::uint32_t height, std::uint32_t x,
           std::uint32_t y, std::uint32_t id) {
    for (std::uint32_t ty = y > 0 ? y - 1 : 0; ty <= std::min(y + 1, height - 1); ++ty) {
        for (std::uint32_t tx = x > 0 ? x - 1 : 0; tx <= std::min(x + 1, width - 1); ++tx) {
            if (ids[std::size_t{ty} * width + tx] == id) return true;
        }
    }
    return false;
}

void copy_row(const Guides& now, const Guides& before, std::span<const HistoryView> from, std::uint32_t y,
              Planes& to) {
    const std::uint32_t width = to.width(), height = to.height();
    for (std::uint32_t c = 0; c < from.size(); ++c)
        std::copy_n(from[c].values + std::size_t{y} * from[c].pitch, width, to.row(c, y));
    for (std::uint32_t x = 0; x < width; ++x) {
        const std::size_t i = std::size_t{y} * width + x;
        const bool same =
            now.ids[i] == before.ids[i] || (shows(before.ids, width, height, x, y, now.ids[i]) &&
                                            shows(now.ids, width, height, x, y, before.ids[i]));
        for (std::uint32_t c = 0; c < from.size() && !same; ++c) to.row(c, y)[x] = 0.0f;
    }
}

}  // namespace

bool reproject(const Guides& now, const Guides& before, const Motion& motion, const SurfaceTests& tests,
               std::span<const HistoryView> from, Planes& to, RunContext& context) {
    const std::uint32_t width = now.inverse_depth.width(), height = now.inverse_depth.height();
    const auto components = static_cast<std::uint32_t>(from.size());
    if (to.width() != width || to.height() != height || to.components() != components) {
        to = Planes(width, height, components);
    }
    return for_rows(context, height, [&](std::uint32_t y) {
        if (motion.still) {
            copy_row(now, before, from, y, to);
            return;
        }
        Lookup lookup(now, before, tests, from);
        const float *to_x = motion.position.row(0, y), *to_y = motion.position.row(1, y);
        const float* expected = motion.inverse_depth.row(0, y);
        for (std::uint32_t x = 0; x < width; ++x) {
            for (std::uint32_t c = 0; c < components; ++c) to.row(c, y)[x] = 0.0f;
            if (!lookup.may_reach(to_x[x], to_y[x])) continue;
            lookup.set_pixel(x, y, expected[x]);
            const Lookup::Found found = lookup.interpolate(to_x[x], to_y[x], x, y, to);
            // Neighbours replace history that the taps missed, not history that is known to be absent.
            if (found == Lookup::Found::Nothing && !motion.identity)
                lookup.average_around(to_x[x], to_y[x], x, y, to);
        }
    });
}

}  // namespace tessera::filter::svgf
