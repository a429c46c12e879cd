#pragma once

#include <functional>

#include "mediator/base/error.h"
#include "mediator/display/frustum.h"
#include "mediator/display/overlap.h"
#include "mediator/display/projector.h"
#include "mediator/display/surface.h"
#include "mediator/display/viewer_preview.h"
#include "tests/display/pipeline_output.h"

// Overlapping synthetic projectors on a wall, and a simulated view of a pattern on the wall.
namespace tessera::display::test {

struct Arrangement {
    std::uint32_t columns = 2, rows = 1;
    double overlap = 0.15;  // of a picture's width and height
    double keystone =
        0.25;  // offset of lenses from the centre of their pictures, relative to the distance from the wall
    double black = 0.0;
    double gamma = 2.2;
    std::uint32_t width = 320, height = 240;
};

using Pattern = std::function<float(double x, double y)>;  // linear light at a position on the wall in metres

class ProjectedWall {
  public:
    static constexpr double Distance = 3.0, Far = -4.0;

    explicit ProjectedWall(const Arrangement& arrangement) : arrangement_(arrangement), arena_(2) {
        const auto [columns, rows, overlap, keystone, black, gamma, width, height] = arrangement;
        const double picture_width = 2.0, picture_height = picture_width * height / width;
        const glm::dvec2 step(picture_width * (1.0 - overlap), picture_height * (1.0 - overlap));
        size_ = {step.x * (columns - 1) + picture_width, step.y * (rows - 1) + picture_height};
        const Wall wall{.corner = {-size_.x / 2, -size_.y / 2, Far},
                        .across = {size_.x, 0, 0},
                        .upward = {0, size_.y, 0}};
        plane_ = projection_plane(wall);
        for (std::uint32_t i = 0; i < columns * rows; ++i) {
            const double side = i % 2 == 0 ? -1.0 : 1.0, above = i % 3 == 0 ? 1.0 : -0.7;
            const glm::dvec3 center(step.x * (i % columns) + (picture_width - size_.x) / 2,
                                    step.y * (i / columns) + (picture_height - size_.y) / 2, Far);
            const Projector projector{
                .position = center + Distance * glm::dvec3(side * keystone * 0.6, above * keystone, 1.0),
                .look_at = center,
                .horizontal_fov = 2.0 * std::atan(0.5 * picture_width / Distance)};
            ProjectorOutput projector_output{
                .projector = pose(projector, double(width) / height), .width = width, .height = height};
            const glm::dvec3 lens = projector.position;
            projector_output.points = sample(
                [&](double u, double v) { return *hit(wall, lens, ray(projector_output.projector, u, v)); },
                width, height);
            projectors_.push_back(std::move(projector_output));
        }
        const std::vector<OverlapMaps> maps = overlap_of(black);
        for (std::size_t i = 0; i < projectors_.size(); ++i)
            outputs_.push_back(output(maps[i], projectors_[i]));
    }

    const std::vector<ProjectorOutput>& projectors() const { return projectors_; }
    const glm::dvec2& size() const { return size_; }
    // Pixel size of the picture of the wall, about that of the devices.
    double pitch() const { return 2.0 / arrangement_.width; }

    // The wall as seen from straight ahead, when each output shows the pattern rendered for the head.
    template <class Value>
    frame::Image projected(const Pattern& pattern) {
        std::vector<frame::Image> lights;
        for (const Output& output : outputs_) {
            OutputPipeline pipeline(output, arrays_);
            const view::CameraPose eye = frustum(output.plane, head_, view::Eye::Mono, 0.0, 0.0);
            pipeline.set_frustum(view::Eye::Mono, eye);
            const auto shown = show<Value>(pipeline, {drawn(output, eye, pattern).half()});
            lights.push_back(light_of(output, std::span<const Value>(shown.pictures[0]), arrangement_.black));
        }
        std::vector<ProjectedOutput> seen_outputs;
        for (std::size_t i = 0; i < lights.size(); ++i)
            seen_outputs.push_back({&projectors_[i].points, &lights[i]});
        const view::CameraPose from_ahead = frustum(plane_, {}, view::Eye::Mono, 0.0, 0.0);
        return viewer_picture(from_ahead, std::uint32_t(size_.x / pitch()), std::uint32_t(size_.y / pitch()),
                              seen_outputs, arena_);
    }

    // Position on the wall of a pixel's centre in that picture, in metres.
    glm::dvec2 position(const frame::Image& image, double x, double y) const {
        return {((x + 0.5) / image.width - 0.5) * size_.x, (0.5 - (y + 0.5) / image.height) * size_.y};
    }

    // Number of projectors that cover the position by more than `margin` pixels from their edges.
    int coverage(const glm::dvec2& position, double margin) const {
        int count = 0;
        for (const ProjectorOutput& projector_output : projectors_) {
            const auto at = image_coordinates(projector_output.projector, {position.x, position.y, Far});
            count += at && std::min(at->x, 1 - at->x) * projector_output.width > margin &&
                     std::min(at->y, 1 - at->y) * projector_output.height > margin;
        }
        return count;
    }

  private:
    std::vector<OverlapMaps> overlap_of(double black) { return display::overlap(projectors_, black, arena_); }

    Output output(const OverlapMaps& maps, const ProjectorOutput& projector_output) {
        Output output{.name = "projector",
                      .width = projector_output.width,
                      .height = projector_output.height,
                      .plane = plane_};
        output.plane.hull = hull(projector_output.points);
        const Size size =
            view_size(projector_output.points, output.plane, head_.position, output.width, output.height);
        output.view_width = size.width;
        output.view_height = size.height;
        std::vector<float> points;
        for (const glm::dvec3& point : projector_output.points.points)
            for (int axis = 0; axis < 3; ++axis) points.push_back(static_cast<float>(point[axis]));
        output.points = put(arrays_, projector_output.points.columns, projector_output.points.rows, 3,
                            projector_output.points.nodes, points);
        const auto one_each = [&](const std::vector<float>& values) {
            return put(arrays_, projector_output.width, projector_output.height, 1, Grid::Nodes::Centres,
                       values);
        };
        output.blend.weights = one_each(maps.weights);
        if (!maps.lift.empty()) output.blend.lift = one_each(maps.lift);
        output.color.gamma = arrangement_.gamma;
        return output;
    }

    // The pattern on the wall as a renderer would render it.
    Picture drawn(const Output& output, const view::CameraPose& eye, const Pattern& pattern) const {
        return {output.view_width, output.view_height, [&](std::uint32_t x, std::uint32_t y) {
                    const glm::dvec3 direction =
                        ray(eye, (x + 0.5) / output.view_width, (y + 0.5) / output.view_height);
                    const glm::dvec3 from(eye.world_from_camera[3]);
                    const glm::dvec3 point = from + direction * ((Far - from.z) / direction.z);
                    const float value = pattern(point.x, point.y);
                    return Rgb{value, value, value};
                }};
    }

    Arrangement arrangement_;
    tbb::task_arena arena_;
    Head head_{.position = {0.4, -0.3, 0.2}};
    glm::dvec2 size_{0.0};
    ProjectionPlane plane_;
    std::vector<ProjectorOutput> projectors_;
    scene::BlobStore arrays_;
    std::vector<Output> outputs_;
};

// The largest relative difference from `expected` of means over squares of `edge` pixels that are covered by
// `projectors` or more, and by at least one with a margin of more than `margin` pixels.
struct Uniformity {
    double error = 0.0;
    int squares = 0, beyond_a_percent = 0;
};
inline Uniformity uniformity(const ProjectedWall& wall, const frame::Image& image, double expected,
                             std::uint32_t edge, int projectors, double margin) {
    Uniformity result;
    for (std::uint32_t top = 0; top + edge <= image.height; top += edge)
        for (std::uint32_t left = 0; left + edge <= image.width; left += edge) {
            double sum = 0.0;
            bool is_covered = true;
            for (std::uint32_t y = top; y < top + edge; ++y)
                for (std::uint32_t x = left; x < left + edge; ++x) {
                    const glm::dvec2 position = wall.position(image, x, y);
                    is_covered = is_covered && wall.coverage(position, margin) > 0 &&
                                 wall.coverage(position, 0.0) >= projectors;
                    sum += image.pixel(std::size_t{y} * image.width + x)[1];
                }
            if (!is_covered) continue;
            const double error = std::abs(sum / (edge * edge) / expected - 1.0);
            ++result.squares;
            result.beyond_a_percent += error > 0.01;
            result.error = std::max(result.error, error);
        }
    return result;
}

}  // namespace tessera::display::test
