#pragma once

#include <glm/vec2.hpp>
#include <string>
#include <vector>

#include "client/tools/canvas.h"

namespace tessera::tools {

// A page of lines, areas and words, in pixels from the top left; drawn in the order of its shapes.
struct Path {
    std::vector<glm::dvec2> points;
    Rgb color{20, 20, 20};
    double width = 1.0;             // of the line; 0 = none
    double line = 1.0, area = 0.0;  // opacities; with an area the path is closed
};
struct Words {
    glm::dvec2 center{0.0};
    std::string text;
    Rgb color{20, 20, 20};
    std::uint32_t scale = 1;  // of the pixel font
};
struct Drawing {
    std::uint32_t width = 0, height = 0;
    std::vector<Path> paths;  // below all words
    std::vector<Words> words;
};

std::string as_svg(const Drawing& drawing);
Canvas as_canvas(const Drawing& drawing);

}  // namespace tessera::tools
