#include "client/tools/display/plan.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>
#include <set>

#include "mediator/display/frustum.h"

namespace tessera::tools {

namespace {

using glm::dvec2;
using glm::dvec3;

constexpr std::uint32_t Width = 1440, Height = 920;
constexpr double Margin = 48.0;
constexpr Rgb Ink{30, 30, 30}, Grey{150, 150, 150}, Faint{215, 215, 215};

Rgb color_of(std::size_t index) {
    constexpr std::array<Rgb, 8> Colors{{{31, 119, 180},
                                         {214, 39, 40},
                                         {44, 160, 44},
                                         {148, 103, 189},
                                         {255, 127, 14},
                                         {23, 140, 160},
                                         {140, 86, 75},
                                         {200, 70, 150}}};
    return Colors[index % Colors.size()];
}

// A panel of the drawing with its viewing direction: display axes of the page's right and up.
struct Panel {
    std::string title;
    dvec2 corner, size;
    dvec3 right, up;
};

dvec2 flat(const Panel& panel, const dvec3& point) {
    return {glm::dot(point, panel.right), -glm::dot(point, panel.up)};
}

// The outline of an output's picture, clockwise from the top left, and its corners.
struct Outline {
    std::vector<dvec3> points;
    std::array<dvec3, 4> corners;
    dvec3 center;
};

Outline outline_of(const display::PointAt& at) {
    constexpr std::uint32_t Steps = 48;
    Outline outline;
    const std::array<dvec2, 4> corners_uv{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
    for (std::size_t side = 0; side < 4; ++side) {
        outline.corners[side] = at(corners_uv[side].x, corners_uv[side].y);
        const dvec2 offset = corners_uv[(side + 1) % 4] - corners_uv[side];
        for (std::uint32_t i = 0; i < Steps; ++i) {
            const dvec2 uv = corners_uv[side] + offset * (double(i) / Steps);
            outline.points.push_back(at(uv.x, uv.y));
        }
    }
    std::erase_if(outline.points, [](const dvec3& p) { return !std::isfinite(p.x + p.y + p.z); });
    outline.center = dvec3(0.0);
    for (const dvec3& point : outline.points) outline.center += point / double(outline.points.size());
    return outline;
}

Outline outline_of(const display::WarpMap& grid) {
    return outline_of([&](double u, double v) {
        return grid.at(std::uint32_t(std::lround(u * (grid.columns - 1))),
                       std::uint32_t(std::lround(v * (grid.rows - 1))));
    });
}

struct Contents {
    std::vector<Outline> screens;  // of projectors
    std::vector<Outline> outputs;
    std::vector<std::string> names;
    std::vector<std::pair<std::size_t, dvec3>> projectors;  // output, position
    dvec3 head, nose;
    std::array<dvec3, 2> eyes;
};

Contents contents_of(const display_file::DisplayFile& file) {
    Contents contents;
    const display::Head& head = file.display.head;
    contents.head = head.position;
    contents.nose = head.orientation * dvec3(0.0, 0.0, -1.0);
    contents.eyes = {display::eye_position(head, view::Eye::Left, file.display.eye_separation),
                     display::eye_position(head, view::Eye::Right, file.display.eye_separation)};
    std::set<std::string> seen;
    for (const display_file::OutputGeometry& geometry : file.geometry) {
        if (geometry.projector && geometry.surface && seen.insert(geometry.screen).second) {
            contents.screens.push_back(
                outline_of([&](double u, double v) { return display::point(*geometry.surface, u, v); }));
        }
    }
    for (std::size_t i = 0; i < file.geometry.size(); ++i) {
        contents.outputs.push_back(outline_of(file.geometry[i].points));
        contents.names.push_back(file.display.outputs[i].name);
        if (file.geometry[i].projector)
            contents.projectors.emplace_back(i, dvec3(file.geometry[i].projector->world_from_camera[3]));
    }
    return contents;
}

std::vector<dvec2> circle(const dvec2& center, double radius) {
    std::vector<dvec2> points;
    for (int i = 0; i < 32; ++i) {
        const double angle = i * std::numbers::pi / 16.0;
        points.push_back(center + radius * dvec2(std::cos(angle), std::sin(angle)));
    }
    return points;
}

// Draws into one panel at a scale in pixels per metre.
class Sketch {
  public:
    Sketch(Drawing& drawing, const Panel& panel, const Contents& contents)
        : drawing_(drawing), panel_(panel), contents_(contents) {
        const auto take = [&](const dvec3& point) {
            least_ = glm::min(least_, flat(panel_, point));
            most_ = glm::max(most_, flat(panel_, point));
        };
        take(contents.head);
        std::ranges::for_each(contents.eyes, take);
        for (const Outline& outline : contents.screens) std::ranges::for_each(outline.points, take);
        for (const Outline& outline : contents.outputs) std::ranges::for_each(outline.points, take);
        for (const auto& projector : contents.projectors) take(projector.second);
    }

    double fitting_scale() const {
        const dvec2 extent = glm::max(most_ - least_, dvec2(1e-9));
        const dvec2 room = panel_.size - 2.0 * Margin;
        return std::min(room.x / extent.x, room.y / extent.y);
    }

    void draw(double scale) {
        scale_ = scale;
        frame();
        for (const Outline& screen : contents_.screens) area(screen, Grey, 0.12);
        for (std::size_t i = 0; i < contents_.outputs.size(); ++i) sight(i);
        for (const auto& [output, position] : contents_.projectors) draw_frustum(output, position);
        for (std::size_t i = 0; i < contents_.outputs.size(); ++i)
            area(contents_.outputs[i], color_of(i), 0.18);
        head();
        for (std::size_t i = 0; i < contents_.outputs.size(); ++i)
            label(on_page(contents_.outputs[i].center), contents_.names[i], color_of(i));
    }

  private:
    void area(const Outline& outline, const Rgb& color, double cover) {
        std::vector<dvec2> points;
        for (const dvec3& point : outline.points) points.push_back(on_page(point));
        drawing_.paths.push_back({.points = std::move(points), .color = color, .width = 1.6, .area = cover});
    }

    dvec2 on_page(const dvec3& point) const {
        return panel_.corner + 0.5 * panel_.size + scale_ * (flat(panel_, point) - 0.5 * (least_ + most_));
    }

    void line(const dvec2& from, const dvec2& to, const Rgb& color, double width, double cover) {
        drawing_.paths.push_back({.points = {from, to}, .color = color, .width = width, .line = cover});
    }

    // Title, origin and a scale bar.
    void frame() {
        const dvec2 c = panel_.corner, s = panel_.size;
        drawing_.paths.push_back(
            {.points = {c, {c.x + s.x, c.y}, c + s, {c.x, c.y + s.y}, c}, .color = Faint});
        drawing_.words.push_back({.center = c + dvec2(0.5 * s.x, 18.0), .text = panel_.title, .scale = 2});
        const dvec2 origin = on_page(dvec3(0.0));
        line(origin - dvec2(6, 0), origin + dvec2(6, 0), Grey, 1.0, 1.0);
        line(origin - dvec2(0, 6), origin + dvec2(0, 6), Grey, 1.0, 1.0);
        const double metres = std::pow(10.0, std::floor(std::log10(0.4 * s.x / scale_)));
        const dvec2 end(c.x + s.x - 16.0, c.y + s.y - 16.0), begin = end - dvec2(metres * scale_, 0.0);
        line(begin, end, Ink, 2.0, 1.0);
        char text[40];
        std::snprintf(text, sizeof text, metres >= 1.0 ? "%.0f m" : "%.3g m", metres);
        drawing_.words.push_back({.center = 0.5 * (begin + end) - dvec2(0.0, 10.0), .text = text});
    }

    void sight(std::size_t output) {
        const dvec2 eye = on_page(contents_.head);
        for (const dvec3& corner : contents_.outputs[output].corners)
            line(eye, on_page(corner), color_of(output), 1.0, 0.25);
    }

    void draw_frustum(std::size_t output, const dvec3& position) {
        const dvec2 lens = on_page(position);
        for (const dvec3& corner : contents_.outputs[output].corners)
            line(lens, on_page(corner), color_of(output), 1.0, 0.6);
        const dvec2 half(7.0, 5.0);
        drawing_.paths.push_back({.points = {lens - half,
                                             {lens.x + half.x, lens.y - half.y},
                                             lens + half,
                                             {lens.x - half.x, lens.y + half.y}},
                                  .color = color_of(output),
                                  .area = 0.8});
    }

    void head() {
        const dvec2 center = on_page(contents_.head);
        const double radius = std::clamp(0.1 * scale_, 6.0, 0.5 * Margin);
        drawing_.paths.push_back(
            {.points = circle(center, radius), .color = Ink, .width = 1.5, .area = 0.12});
        const dvec2 nose = on_page(contents_.head + contents_.nose) - center;
        const double seen = glm::length(nose);
        if (seen > 1e-6 * scale_)
            line(center, center + nose * (1.8 * radius / seen * std::min(1.0, seen / scale_)), Ink, 1.5, 1.0);
        for (const dvec3& eye : contents_.eyes) {
            const dvec2 offset = on_page(eye) - center;
            const double length = glm::length(offset);
            // Drawn apart even if a few centimetres are less than a pixel.
            const dvec2 at = length > 1e-9 ? center + offset * (std::max(length, 3.0) / length) : center;
            drawing_.paths.push_back({.points = circle(at, 2.0), .color = Ink, .width = 0.0, .area = 1.0});
        }
    }

    // Skipped if it would overlap an existing label.
    void label(const dvec2& center, const std::string& name, const Rgb& color) {
        const std::uint32_t scale = contents_.outputs.size() > 12 ? 1 : 2;
        const dvec2 half(0.5 * text_width(scale, name) + 2.0, 4.0 * scale + 2.0);
        for (const auto& [other, extent] : labels_) {
            const dvec2 apart = glm::abs(other - center) - (extent + half);
            if (apart.x < 0.0 && apart.y < 0.0) return;
        }
        labels_.emplace_back(center, half);
        drawing_.words.push_back({.center = center, .text = name, .color = color, .scale = scale});
    }

    Drawing& drawing_;
    Panel panel_;
    const Contents& contents_;
    dvec2 least_{std::numeric_limits<double>::infinity()}, most_{-std::numeric_limits<double>::infinity()};
    double scale_ = 1.0;
    std::vector<std::pair<dvec2, dvec2>> labels_;  // centre, half the size
};

}  // namespace

Drawing plan(const display_file::DisplayFile& file) {
    Drawing drawing{.width = Width, .height = Height, .paths = {}, .words = {}};
    const Contents contents = contents_of(file);
    // From behind the head, from the right and above.
    const double turn = 0.55, down = 0.45;
    const dvec3 right(std::cos(turn), 0.0, -std::sin(turn));
    const dvec3 up(-std::sin(down) * std::sin(turn), std::cos(down), -std::sin(down) * std::cos(turn));
    const double column = 580.0, row = 0.5 * Height - 18.0;
    Sketch above(drawing, {"from above", {12, 12}, {column, row}, {1, 0, 0}, {0, 0, -1}}, contents);
    Sketch front(drawing, {"from the front", {12, row + 24}, {column, row}, {1, 0, 0}, {0, 1, 0}}, contents);
    Sketch behind(
        drawing,
        {"'" + file.display.name + "'", {column + 24, 12}, {Width - column - 36, Height - 24.0}, right, up},
        contents);
    const double scale = std::min(above.fitting_scale(), front.fitting_scale());
    above.draw(scale);
    front.draw(scale);
    behind.draw(behind.fitting_scale());
    return drawing;
}

}  // namespace tessera::tools
