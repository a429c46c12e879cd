#include "mediator/display/audience.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <limits>

#include "mediator/base/parallel.h"
#include "mediator/display/bilinear_patch.h"
#include "mediator/display/grid_places.h"
#include "mediator/display/projector.h"
#include "mediator/display/turn.h"

namespace tessera::display {

namespace {

constexpr double Nowhere = std::numeric_limits<double>::quiet_NaN();

glm::dmat3 light_from_device(const Color& color) {
    glm::dmat3 device_from_light = color.matrix;
    for (int column = 0; column < 3; ++column) device_from_light[column] *= color.gain;
    return glm::inverse(device_from_light);
}

// `light` of a device value, by component.
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
            const Place to = upright_place(output.turn, {x, y}, output.width, output.height);
            for (int c = 0; c < 3; ++c)
                image.pixel(to.y * image.width + to.x)[static_cast<std::size_t>(c)] =
                    static_cast<float>(black + (1.0 - black) * rgb[c]);
        }
    return image;
}

// For each pixel of the picture the place of an output's picture that is seen there.
class Places {
  public:
    Places(std::uint32_t width, std::uint32_t height)
        : width_(width), height_(height), places_(std::size_t{width} * height, glm::dvec2(Nowhere)) {}

    void draw(const GridCell& in, const BilinearPatch& patch) {
        patch.for_each_pixel(width_, height_, [&](std::size_t x, std::size_t y, const glm::dvec2& way) {
            places_[y * width_ + x] = {in.left + way.x * (in.right - in.left),
                                       in.top + way.y * (in.bottom - in.top)};
        });
    }

    const glm::dvec2& at(std::size_t x, std::size_t y) const { return places_[y * width_ + x]; }

  private:
    std::uint32_t width_, height_;
    std::vector<glm::dvec2> places_;
};

Places places_of(const PointGrid& grid, const view::CameraPose& camera, std::uint32_t width,
                 std::uint32_t height) {
    Places places(width, height);
    const auto project = [&](double u, double v) {
        const glm::dvec3 point = point_at(grid, u, v);
        const auto place = place_in_picture(camera, point);
        return place ? *place * glm::dvec2(width, height) : glm::dvec2(Nowhere);
    };
    for (std::uint32_t row = 0; row < cell_rows(grid); ++row)
        for (std::uint32_t column = 0; column < cell_columns(grid); ++column) {
            const GridCell in = cell(grid, column, row);
            places.draw(in, {{project(in.left, in.top), project(in.right, in.top),
                              project(in.left, in.bottom), project(in.right, in.bottom)}});
        }
    return places;
}

void add_bilinear(const frame::Image& light, const glm::dvec2& place, std::span<float> sum) {
    const auto between = [](double at, std::uint32_t size, std::size_t& first, std::size_t& second) {
        const double inside = std::clamp(at * size - 0.5, 0.0, double(size - 1));
        first = std::min(std::size_t(inside), std::size_t{size} - 1);
        second = std::min(first + 1, std::size_t{size} - 1);
        return inside - double(first);
    };
    std::size_t left = 0, right = 0, top = 0, bottom = 0;
    const double across = between(place.x, light.width, left, right),
                 down = between(place.y, light.height, top, bottom);
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
                const Place at = from(x, y);
                std::ranges::copy(light.pixel(at.y * light.width + at.x), part.pixel(y * width + x).begin());
            }
        return part;
    };
    if (output.stereo == Stereo::SideBySide)
        return taken(half_width, light.height, [&](std::size_t x, std::size_t y) {
            return Place{x + (is_right ? half_width : 0), y};
        });
    if (output.stereo == Stereo::TopBottom)
        return taken(light.width, half_height, [&](std::size_t x, std::size_t y) {
            return Place{x, y + (is_right ? half_height : 0)};
        });
    if (output.stereo == Stereo::InterlacedRows)
        return taken(light.width, light.height, [&](std::size_t x, std::size_t y) {
            const bool is_other = ((output.y + static_cast<std::int64_t>(y)) & 1) != (is_right ? 1 : 0);
            return Place{x, is_other ? (y > 0 ? y - 1 : std::min(y + 1, std::size_t{light.height} - 1)) : y};
        });
    return light;
}

frame::Image seen(const view::CameraPose& camera, std::uint32_t width, std::uint32_t height,
                  std::span<const SeenOutput> outputs, tbb::task_arena& arena) {
    frame::Image picture(width, height, 3);
    for (const SeenOutput& output : outputs) {
        const Places places = places_of(*output.points, camera, width, height);
        parallel_for(arena, height, [&](std::size_t y) {
            for (std::size_t x = 0; x < width; ++x)
                if (const glm::dvec2 place = places.at(x, y); !std::isnan(place.x))
                    add_bilinear(*output.light, place, picture.pixel(y * width + x));
        });
    }
    return picture;
}

}  // namespace tessera::display
