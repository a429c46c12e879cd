#include "client/tools/display/drawing.h"

#include <array>
#include <cstdio>

#include "client/tools/formatted.h"
#include "client/tools/markup.h"
#include "mediator/display/pixel_font.h"

namespace tessera::tools {

namespace {

using glm::dvec2;

std::string color_text(const Rgb& color) {
    return formatted("#%02x%02x%02x", color[0], color[1], color[2]);
}

}  // namespace

std::string as_svg(const Drawing& drawing) {
    std::string svg = formatted(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%u\" height=\"%u\" viewBox=\"0 0 %u %u\">\n"
        "<rect width=\"100%%\" height=\"100%%\" fill=\"#ffffff\"/>\n",
        drawing.width, drawing.height, drawing.width, drawing.height);
    for (const Path& path : drawing.paths) {
        svg += "<path d=\"";
        for (std::size_t i = 0; i < path.points.size(); ++i)
            svg += formatted("%s%.1f %.1f", i == 0 ? "M" : " L", path.points[i].x, path.points[i].y);
        svg += std::string(path.area > 0.0 ? " Z" : "") + "\" fill=\"" +
               (path.area > 0.0 ? color_text(path.color) : "none") +
               formatted("\" fill-opacity=\"%.3g\" stroke-width=\"%.3g\" stroke-opacity=\"%.3g\" stroke=\"",
                         path.area, path.width, path.line) +
               (path.width > 0.0 ? color_text(path.color) : "none") + "\"/>\n";
    }
    for (const Words& words : drawing.words) {
        const double size = 9.5 * words.scale;
        svg += formatted(
                   "<text x=\"%.1f\" y=\"%.1f\" font-size=\"%.1f\" font-family=\"monospace\" "
                   "text-anchor=\"middle\" stroke=\"#ffffff\" stroke-width=\"3\" stroke-opacity=\"0.7\" "
                   "paint-order=\"stroke\" fill=\"",
                   words.center.x, words.center.y + 0.35 * size, size) +
               color_text(words.color) + "\">" + escaped(words.text) + "</text>\n";
    }
    return svg + "</svg>\n";
}

Canvas as_canvas(const Drawing& drawing) {
    Canvas canvas(drawing.width, drawing.height, 255);
    for (const Path& path : drawing.paths) {
        if (path.area > 0.0) fill_polygon(canvas, path.points, path.color, path.area);
        if (!(path.width > 0.0)) continue;
        for (std::size_t i = 0; i + 1 < path.points.size(); ++i)
            draw_line(canvas, path.points[i], path.points[i + 1], path.width, path.color, path.line);
        if (path.area > 0.0 && path.points.size() > 1)
            draw_line(canvas, path.points.back(), path.points.front(), path.width, path.color, path.line);
    }
    for (const Words& words : drawing.words) {
        const double width = text_width(words.scale, words.text), height = display::GlyphHeight * words.scale;
        const dvec2 half(0.5 * width + 2.0, 0.5 * height + 1.0);
        const std::array<dvec2, 4> room{
            words.center - half, dvec2(words.center.x + half.x, words.center.y - half.y), words.center + half,
            dvec2(words.center.x - half.x, words.center.y + half.y)};
        fill_polygon(canvas, room, {255, 255, 255}, 0.7);
        draw_text(canvas, std::int64_t(words.center.x - 0.5 * width),
                  std::int64_t(words.center.y - 0.5 * height), words.scale, words.text, words.color);
    }
    return canvas;
}

}  // namespace tessera::tools
