#include "mediator/display/wall_grid.h"

#include <glm/geometric.hpp>

#include "mediator/base/error.h"

namespace tessera::display {

namespace {

// From the lower end of the axis. `bezel` as a fraction of the whole.
struct GridAxis {
    std::uint32_t count, pixels, overlap;
    double bezel;

    std::pair<double, double> ends(std::uint32_t index) const {
        // With neither bezel nor overlap an end is a quotient of whole numbers, identical for neighbours.
        const double advance = double(pixels - overlap), total = advance * count + overlap;
        const double visible = 1.0 - bezel * (count - 1);
        const double begin = advance * index, end = begin + pixels;
        return {begin / total * visible + bezel * index, end / total * visible + bezel * index};
    }
};

GridAxis axis(std::uint32_t count, std::uint32_t pixels, std::uint32_t overlap, double bezel,
              const char* name) {
    const std::string direction(name);
    if (overlap > 0 && bezel > 0.0) {
        throw Error(ErrorCode::InvalidInput,
                    "outputs have bezels and overlap " + direction + ": give only one of them");
    }
    if (count > 1 && overlap > pixels / 2) {
        throw Error(ErrorCode::InvalidInput, "outputs overlap " + direction + " by more than half of their " +
                                                 std::to_string(pixels) +
                                                 " pixels: at most two pictures may overlap");
    }
    if (!(bezel * (count - 1) < 1.0))
        throw Error(ErrorCode::InvalidInput, "the bezels " + direction + " leave nothing of the wall");
    return {count, pixels, count > 1 ? overlap : 0, bezel};
}

}  // namespace

std::vector<Part> parts(const Wall& wall, const WallGrid& grid) {
    const GridAxis across = axis(grid.columns, grid.width, grid.overlap_across,
                                 grid.bezel_across / glm::length(wall.across), "across");
    const GridAxis upward = axis(grid.rows, grid.height, grid.overlap_upward,
                                 grid.bezel_upward / glm::length(wall.upward), "upward");
    std::vector<Part> parts;
    for (std::uint32_t row = 0; row < grid.rows; ++row) {
        const auto [bottom, top] = upward.ends(grid.rows - 1 - row);
        for (std::uint32_t column = 0; column < grid.columns; ++column) {
            const auto [left, right] = across.ends(column);
            parts.push_back({left, right, bottom, top});
        }
    }
    return parts;
}

}  // namespace tessera::display
