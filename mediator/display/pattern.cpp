#include "mediator/display/pattern.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <limits>
#include <optional>
#include <string>

#include "mediator/display/pixel_font.h"
#include "mediator/display/turn.h"

namespace tessera::display {

namespace {

using glm::dvec2;
using glm::vec3;

constexpr float Background = 0.02f, Line = 0.25f, Axis = 0.6f, White = 1.0f;

float light_of_step(double step) {  // of 256, by sRGB
    const double value = step / 255.0;
    return float(value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4));
}

// A magnified line of text, centred at a position of the picture.
class Label {
  public:
    Label(std::string text, const dvec2& center, const dvec2& room) : text_(std::move(text)) {
        const double width = double(GlyphAdvance) * double(std::max<std::size_t>(1, text_.size()));
        scale_ = std::floor(std::min(room.x / width, room.y / GlyphHeight));
        corner_ = center - 0.5 * scale_ * dvec2(width - 1.0, GlyphHeight - 1.0);
    }
    // Keeps a dark margin of one dot, so that lines do not touch letters.
    bool contains(const dvec2& at) const {
        const dvec2 dot = (at - corner_) / std::max(scale_, 1.0);
        return scale_ >= 1.0 && !text_.empty() && dot.x >= -1.0 && dot.y >= -1.0 &&
               dot.x < double(GlyphAdvance) * double(text_.size()) && dot.y < GlyphHeight + 1.0;
    }
    bool covers(const dvec2& at) const {
        const dvec2 dot = (at - corner_) / std::max(scale_, 1.0);
        return scale_ >= 1.0 && dot.x >= 0.0 && dot.y >= 0.0 &&
               is_in_text(text_, std::uint32_t(dot.x), std::uint32_t(dot.y));
    }

  private:
    std::string text_;
    double scale_;
    dvec2 corner_;
};

// Steps of light from left to right, outside of overlaps of up to a fifth; null where (u, v) is not on one of the
// ramps.
std::optional<vec3> ramp(double u, double v) {
    constexpr double Left = 0.15, Right = 0.85, Top = 0.60, Height = 0.032;
    if (u < Left || u >= Right || v < Top) return std::nullopt;
    const double along = (u - Left) / (Right - Left);
    const int bar = int((v - Top) / Height);
    const float all = light_of_step(std::floor(256.0 * along));
    switch (bar) {
        case 0:
            return vec3(light_of_step(std::floor(32.0 * along)));
        case 1:
            return vec3(all);
        case 2:
            return vec3(all, 0.0f, 0.0f);
        case 3:
            return vec3(0.0f, all, 0.0f);
        case 4:
            return vec3(0.0f, 0.0f, all);
        default:
            return std::nullopt;
    }
}

// The part of the projection plane that the picture shows, in metres from the plane's origin.
struct Extent {
    dvec2 least, most;
};
Extent extent(const ProjectionPlane& plane) {
    Extent box{dvec2(std::numeric_limits<double>::infinity()),
               dvec2(-std::numeric_limits<double>::infinity())};
    for (const glm::dvec3& point : plane.hull) {
        const glm::dvec3 offset = point - plane.origin;
        const dvec2 at(glm::dot(offset, plane.right), glm::dot(offset, plane.up));
        box.least = glm::min(box.least, at);
        box.most = glm::max(box.most, at);
    }
    return box;
}

class Pattern {
  public:
    Pattern(const Output& output, view::Eye eye)
        : size_(output.view_width, output.view_height),
          box_(extent(output.plane)),
          pitch_((box_.most - box_.least) / size_),
          name_(output.name, size_ * dvec2(0.5, 0.30), size_ * dvec2(0.6, 0.12)),
          numbers_(std::to_string(output.width) + "x" + std::to_string(output.height),
                   size_ * dvec2(0.5, 0.40), size_ * dvec2(0.3, 0.05)),
          mark_(eye == view::Eye::Left    ? "L"
                : eye == view::Eye::Right ? "R"
                                          : "",
                size_ * dvec2(eye == view::Eye::Left ? 0.2 : 0.8, 0.5), size_ * dvec2(0.15, 0.3)) {
        const dvec2 metres = box_.most - box_.least;
        const double shorter = std::min(metres.x, metres.y);
        spacing_ = std::exp2(std::floor(std::log2(shorter / 6.0)));
        radius_ = 0.47 * shorter;
    }

    vec3 at(std::uint32_t x, std::uint32_t y) const {
        const dvec2 position(x + 0.5, y + 0.5);
        const dvec2 to_edge = glm::min(position, size_ - position);
        if (std::min(to_edge.x, to_edge.y) < border()) return vec3(White);
        if (const auto step = ramp(position.x / size_.x, position.y / size_.y)) return *step;
        for (const Label* label : {&name_, &numbers_, &mark_}) {
            if (label->contains(position)) return vec3(label->covers(position) ? White : Background);
        }
        return vec3(lines(position));
    }

  private:
    double border() const { return std::min(size_.x, size_.y) >= 64.0 ? 2.0 : 1.0; }

    // Coverage of a pixel by a line of two pixels width, `metres` from its centre.
    static float coverage(double metres, double pitch) {
        return float(std::clamp(1.5 - std::abs(metres) / pitch, 0.0, 1.0));
    }

    float lines(const dvec2& position) const {
        const dvec2 metres(box_.least.x + position.x * pitch_.x, box_.most.y - position.y * pitch_.y);
        float light = Background;
        const auto draw = [&](float of_line, float covered) {
            light = std::max(light, Background + (of_line - Background) * covered);
        };
        for (int axis = 0; axis < 2; ++axis) {
            const double off = metres[axis] - spacing_ * std::round(metres[axis] / spacing_);
            draw(Line, coverage(off, pitch_[axis]));
        }
        const dvec2 from_center = metres - 0.5 * (box_.least + box_.most);
        for (int axis = 0; axis < 2; ++axis) {
            if (std::abs(from_center[1 - axis]) < 0.5 * spacing_)
                draw(Axis, coverage(from_center[axis], pitch_[axis]));
        }
        draw(Axis, coverage(glm::length(from_center) - radius_, std::max(pitch_.x, pitch_.y)));
        return light;
    }

    dvec2 size_;
    Extent box_;
    dvec2 pitch_;  // metres a pixel
    Label name_, numbers_, mark_;
    double spacing_ = 1.0, radius_ = 0.0;
};

}  // namespace

frame::Image pattern(const Output& output, view::Eye eye) {
    const Pattern drawn(output, eye);
    frame::Image image(output.view_width, output.view_height, 3);
    for (std::uint32_t y = 0; y < image.height; ++y) {
        for (std::uint32_t x = 0; x < image.width; ++x) {
            const vec3 light = drawn.at(x, y);
            std::copy_n(&light.x, 3, image.pixel(std::size_t{y} * image.width + x).begin());
        }
    }
    return image;
}

Output raw(const Output& output) {
    Output plain = output;
    plain.points = {};
    plain.blend = {};
    plain.color = {};
    const bool is_on_side = swaps_edges(output.turn);
    plain.view_width = is_on_side ? output.height : output.width;
    plain.view_height = is_on_side ? output.width : output.height;
    plain.plane = {.hull = {{0.0, 0.0, -1.0},
                            {0.001 * plain.view_width, 0.0, -1.0},
                            {0.0, 0.001 * plain.view_height, -1.0},
                            {0.001 * plain.view_width, 0.001 * plain.view_height, -1.0}}};
    return plain;
}

}  // namespace tessera::display
