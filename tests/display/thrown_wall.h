#pragma once

#include <functional>

#include "mediator/base/error.h"
#include "mediator/display/audience.h"
#include "mediator/display/frustum.h"
#include "mediator/display/overlap.h"
#include "mediator/display/projector.h"
#include "mediator/display/surface.h"
#include "tests/display/shown.h"

// Synthetic projectors that overlap on a wall, and what people see of a pattern that is drawn on the wall.
namespace tessera::display::test {

struct Arrangement {
    std::uint32_t columns = 2, rows = 1;
    double overlap = 0.15;  // of a picture's width and height
    double keystone =
        0.25;  // how far lenses are off the middle of their pictures, in distances from the wall
    double black = 0.0;
    double gamma = 2.2;
    std::uint32_t width = 320, height = 240;
};

using Pattern = std::function<float(double x, double y)>;  // linear light at metres of the wall

class ThrownWall {
  public:
    static constexpr double Distance = 3.0, Far = -4.0;

    explicit ThrownWall(const Arrangement& arrangement) : arrangement_(arrangement), arena_(2) {
        const auto [columns, rows, overlap, keystone, black, gamma, width, height] = arrangement;
        const double picture_width = 2.0, picture_height = picture_width * height / width;
        const glm::dvec2 step(picture_width * (1.0 - overlap), picture_height * (1.0 - overlap));
        size_ = {step.x * (columns - 1) + picture_width, step.y * (rows - 1) + picture_height};
        const Wall wall{.corner = {-size_.x / 2, -size_.y / 2, Far},
                        .across = {size_.x, 0, 0},
                        .upward = {0, size_.y, 0}};
        plane_ = view_plane(wall);
        for (std::uint32_t i = 0; i < columns * rows; ++i) {
            const double side = i % 2 == 0 ? -1.0 : 1.0, above = i % 3 == 0 ? 1.0 : -0.7;
            const glm::dvec3 middle(step.x * (i % columns) + (picture_width - size_.x) / 2,
                                    step.y * (i / columns) + (picture_height - size_.y) / 2, Far);
            const Projector projector{
                .position = middle + Distance * glm::dvec3(side * keystone * 0.6, above * keystone, 1.0),
                .look_at = middle,
                .horizontal_fov = 2.0 * std::atan(0.5 * picture_width / Distance)};
            Thrower thrower{
                .projector = pose(projector, double(width) / height), .width = width, .height = height};
            const glm::dvec3 lens = projector.position;
            thrower.points =
                sample([&](double u, double v) { return *hit(wall, lens, ray(thrower.projector, u, v)); },
                       width, height);
            throwers_.push_back(std::move(thrower));
        }
        const std::vector<OverlapMaps> maps = overlap_of(black);
        for (std::size_t i = 0; i < throwers_.size(); ++i) outputs_.push_back(output(maps[i], throwers_[i]));
    }

    const std::vector<Thrower>& throwers() const { return throwers_; }
    const glm::dvec2& size() const { return size_; }
    // Of a pixel of the picture of the wall, which is about as large as a device's.
    double pitch() const { return 2.0 / arrangement_.width; }

    // The wall as people see it, from straight ahead, when each output shows the pattern as the head sees it.
    template <class Value>
    frame::Image thrown(const Pattern& pattern) {
        std::vector<frame::Image> lights;
        for (const Output& output : outputs_) {
            OutputPipeline pipeline(output, arrays_);
            const view::CameraPose eye = frustum(output.plane, head_, view::Eye::Mono, 0.0, 0.0);
            pipeline.set_frustum(view::Eye::Mono, eye);
            const auto shown = show<Value>(pipeline, {drawn(output, eye, pattern).half()});
            lights.push_back(light_of(output, std::span<const Value>(shown.pictures[0]), arrangement_.black));
        }
        std::vector<SeenOutput> seen_outputs;
        for (std::size_t i = 0; i < lights.size(); ++i)
            seen_outputs.push_back({&throwers_[i].points, &lights[i]});
        const view::CameraPose from_ahead = frustum(plane_, {}, view::Eye::Mono, 0.0, 0.0);
        return seen(from_ahead, std::uint32_t(size_.x / pitch()), std::uint32_t(size_.y / pitch()),
                    seen_outputs, arena_);
    }

    // Metres of the wall in the middle of a pixel of that picture.
    glm::dvec2 place(const frame::Image& image, double x, double y) const {
        return {((x + 0.5) / image.width - 0.5) * size_.x, (0.5 - (y + 0.5) / image.height) * size_.y};
    }

    // How many projectors reach the place, further than `margin` pixels from their edges.
    int reached(const glm::dvec2& place, double margin) const {
        int count = 0;
        for (const Thrower& thrower : throwers_) {
            const auto at = place_in_picture(thrower.projector, {place.x, place.y, Far});
            count += at && std::min(at->x, 1 - at->x) * thrower.width > margin &&
                     std::min(at->y, 1 - at->y) * thrower.height > margin;
        }
        return count;
    }

  private:
    std::vector<OverlapMaps> overlap_of(double black) { return display::overlap(throwers_, black, arena_); }

    Output output(const OverlapMaps& maps, const Thrower& thrower) {
        Output output{.name = "projector", .width = thrower.width, .height = thrower.height, .plane = plane_};
        output.plane.hull = hull(thrower.points);
        const Size size =
            view_size(thrower.points, output.plane, head_.position, output.width, output.height);
        output.view_width = size.width;
        output.view_height = size.height;
        std::vector<float> points;
        for (const glm::dvec3& point : thrower.points.points)
            for (int axis = 0; axis < 3; ++axis) points.push_back(static_cast<float>(point[axis]));
        output.points =
            put(arrays_, thrower.points.columns, thrower.points.rows, 3, thrower.points.nodes, points);
        const auto one_each = [&](const std::vector<float>& values) {
            return put(arrays_, thrower.width, thrower.height, 1, Grid::Nodes::Centres, values);
        };
        output.blend.weights = one_each(maps.weights);
        if (!maps.lift.empty()) output.blend.lift = one_each(maps.lift);
        output.color.gamma = arrangement_.gamma;
        return output;
    }

    // The pattern as a renderer would see it on the wall.
    Picture drawn(const Output& output, const view::CameraPose& eye, const Pattern& pattern) const {
        return {output.view_width, output.view_height, [&](std::uint32_t x, std::uint32_t y) {
                    const glm::dvec3 way =
                        ray(eye, (x + 0.5) / output.view_width, (y + 0.5) / output.view_height);
                    const glm::dvec3 from(eye.world_from_camera[3]);
                    const glm::dvec3 point = from + way * ((Far - from.z) / way.z);
                    const float value = pattern(point.x, point.y);
                    return Rgb{value, value, value};
                }};
    }

    Arrangement arrangement_;
    tbb::task_arena arena_;
    Head head_{.position = {0.4, -0.3, 0.2}};
    glm::dvec2 size_{0.0};
    ViewPlane plane_;
    std::vector<Thrower> throwers_;
    scene::BlobStore arrays_;
    std::vector<Output> outputs_;
};

// The largest difference from `expected`, as a part of it, of means over squares of `edge` pixels that
// `projectors` or more reach, and that at least one reaches further than `margin` pixels from its edges.
struct Uniformity {
    double error = 0.0;
    int squares = 0, beyond_a_percent = 0;
};
inline Uniformity uniformity(const ThrownWall& wall, const frame::Image& image, double expected,
                             std::uint32_t edge, int projectors, double margin) {
    Uniformity result;
    for (std::uint32_t top = 0; top + edge <= image.height; top += edge)
        for (std::uint32_t left = 0; left + edge <= image.width; left += edge) {
            double sum = 0.0;
            bool is_reached = true;
            for (std::uint32_t y = top; y < top + edge; ++y)
                for (std::uint32_t x = left; x < left + edge; ++x) {
                    const glm::dvec2 place = wall.place(image, x, y);
                    is_reached = is_reached && wall.reached(place, margin) > 0 &&
                                 wall.reached(place, 0.0) >= projectors;
                    sum += image.pixel(std::size_t{y} * image.width + x)[1];
                }
            if (!is_reached) continue;
            const double error = std::abs(sum / (edge * edge) / expected - 1.0);
            ++result.squares;
            result.beyond_a_percent += error > 0.01;
            result.error = std::max(result.error, error);
        }
    return result;
}

}  // namespace tessera::display::test
