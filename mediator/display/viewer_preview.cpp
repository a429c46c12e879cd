#include "mediator/display/viewer_preview.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <limits>

#include "mediator/base/parallel.h"
#include "mediator/display/bilinear_patch.h"
#include "mediator/display/projector.h"
#include "mediator/display/turn.h"
#include "mediator/display/warp_map_cells.h"

namespace tessera::display {

namespace {

constexpr double Nowhere = std::numeric_limits<double>::quiet_NaN();

glm::dmat3 light_from_device(const Color& color) {
    glm::dmat3 device_from_light = color.matrix;
    for (int column = 0; column < 3; ++column) device_from_light[column] *= color.gain;
    return glm::inverse(device_from_light);
}

// `light` of a device value, per component.
template <class Light>
frame::Image upright_light(const Output& output, const Light& light, double black) {
    const bool is_on_side = swaps_edges(output.turn);
    frame::Image image(is_on_side ? output.height : output.width, is_on_side ? output.width : output.height,
                       3);
    const glm::dmat3 matrix = light_from_device(output.color);
    for (std::size_t y = 0; y < output.height; ++y)
        for (std::size_t x = 0; x < output.width; ++x) {
            const std::size_t from = 3 * (y * output.width + x);
            const glm::dvec3 rgb = matrix * glm::dvec3(light(from), light(from + 1), light(from + 2));
            const PixelPosition to = upright_position(output.turn, {x, y}, output.width, output.height);
            for (int c = 0; c < 3; ++c)
                image.pixel(to.y * image.width + to.x)[static_cast<std::size_t>(c)] =
                    static_cast<float>(black + (1.0 - black) * rgb[c]);
        }
    return image;
}

// For each pixel of the picture, the coordinates in an output's picture that are seen there.
class VisibleCoordinates {
  public:
    VisibleCoordinates(std::uint32_t width, std::uint32_t height)
        : width_(width), height_(height), uv_(std::size_t{width} * height, glm::dvec2(Nowhere)) {}

    void draw(const GridCell& in, const BilinearPatch& patch) {
        patch.for_each_pixel(width_, height_, [&](std::size_t x, std::size_t y, const glm::dvec2& uv) {
            uv_[y * width_ + x] = {in.left + uv.x * (in.right - in.left),
                                   in.top + uv.y * (in.bottom - in.top)};
        });
    }

    const glm::dvec2& at(std::size_t x, std::size_t y) const { return uv_[y * width_ + x]; }

  private:
    std::uint32_t width_, height_;
    std::vector<glm::dvec2> uv_;
};

VisibleCoordinates visible_coordinates(const WarpMap& grid, const view::CameraPose& camera,
                                       std::uint32_t width, std::uint32_t height) {
    VisibleCoordinates visible(width, height);
    const auto project = [&](double u, double v) {
        const glm::dvec3 point = point_at(grid, u, v);
        const auto position = image_coordinates(camera, point);
        return position ? *position * glm::dvec2(width, height) : glm::dvec2(Nowhere);
    };
    for (std::uint32_t row = 0; row < cell_rows(grid); ++row)
        for (std::uint32_t column = 0; column < cell_columns(grid); ++column) {
            const GridCell in = cell(grid, column, row);
            visible.draw(in, {{project(in.left, in.top), project(in.right, in.top),
                               project(in.left, in.bottom), project(in.right, in.bottom)}});
        }
    return visible;
}

void add_bilinear(const frame::Image& light, const glm::dvec2& uv, std::span<float> sum) {
    const auto between = [](double at, std::uint32_t size, std::size_t& first, std::size_t& second) {
        const double inside = std::clamp(at * size - 0.5, 0.0, double(size - 1));
        first = std::min(std::size_t(inside), std::size_t{size} - 1);
        second = std::min(first + 1, std::size_t{size} - 1);
        return inside - double(first);
    };
    std::size_t left = 0, right = 0, top = 0, bottom = 0;
    const double across = between(uv.x, light.width, left, right),
                 down = between(uv.y, light.height, top, bottom);
    const auto a = light.pixel(top * light.width + left), b = light.pixel(top * light.width + right),
               c = light.pixel(bottom * light.width + left), d = light.pixel(bottom * light.width + right);
    for (std::size_t i = 0; i < 3; ++i)
        sum[i] += static_cast<float>((1.0 - down) * ((1.0 - across) * a[i] + across * b[i]) +
                                     down * ((1.0 - across) * c[i] + across * d[i]));
}

}  // namespace

frame::Image light_of(const Output& output, std::span<const float> device_values, double black) {
    const DeviceColor color(output.color);
    return upright_light(
        output, [&](std::size_t i) { return color.light(device_values[i]); }, black);
}

frame::Image light_of(const Output& output, std::span<const std::uint8_t> device_bytes, double black) {
    const DeviceColor color(output.color);
    std::array<double, 256> lights;
    for (std::size_t code = 0; code < lights.size(); ++code)
        lights[code] = color.light(static_cast<double>(code) / 255.0);
    return upright_light(
        output, [&](std::size_t i) { return lights[device_bytes[i]]; }, black);
}

frame::Image part_of_eye(const Output& output, const frame::Image& light, view::Eye eye) {
    const bool is_right = eye == view::Eye::Right;
    const std::uint32_t half_width = light.width / 2, half_height = light.height / 2;
    const auto taken = [&](std::uint32_t width, std::uint32_t height, const auto& from) {
        frame::Image part(width, height, 3);
        for (std::uint32_t y = 0; y < height; ++y)
            for (std::uint32_t x = 0; x < width; ++x) {
                const PixelPosition at = from(x, y);
                std::ranges::copy(light.pixel(at.y * light.width + at.x), part.pixel(y * width + x).begin());
            }
        return part;
    };
    if (output.stereo == Stereo::SideBySide)
        return taken(half_width, light.height, [&](std::size_t x, std::size_t y) {
            return PixelPosition{x + (is_right ? half_width : 0), y};
        });
    if (output.stereo == Stereo::TopBottom)
        return taken(light.width, half_height, [&](std::size_t x, std::size_t y) {
            return PixelPosition{x, y + (is_right ? half_height : 0)};
        });
    if (output.stereo == Stereo::InterlacedRows)
        return taken(light.width, light.height, [&](std::size_t x, std::size_t y) {
            const bool is_other = ((output.y + static_cast<std::int64_t>(y)) & 1) != (is_right ? 1 : 0);
            return PixelPosition{
                x, is_other ? (y > 0 ? y - 1 : std::min(y + 1, std::size_t{light.height} - 1)) : y};
        });
    return light;
}

frame::Image viewer_picture(const view::CameraPose& camera, std::uint32_t width, std::uint32_t height,
                            std::span<const ProjectedOutput> outputs, tbb::task_arena& arena) {
    frame::Image picture(width, height, 3);
    for (const ProjectedOutput& output : outputs) {
        const VisibleCoordinates visible = visible_coordinates(*output.points, camera, width, height);
        parallel_for(arena, height, [&](std::size_t y) {
            for (std::size_t x = 0; x < width; ++x)
                if (const glm::dvec2 uv = visible.at(x, y); !std::isnan(uv.x))
                    add_bilinear(*output.light, uv, picture.pixel(y * width + x));
        });
    }
    return picture;
}

}  // namespace tessera::display
