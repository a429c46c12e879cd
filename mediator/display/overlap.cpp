#include "mediator/display/overlap.h"

#include <algorithm>

#include "mediator/base/parallel.h"
#include "mediator/display/projector.h"
#include "mediator/display/warp_map_cells.h"

namespace tessera::display {

namespace {

// Pixels to the nearest edge of the picture; not positive outside.
double distance_to_edge(const ProjectorOutput& projector_output, double u, double v) {
    return std::min(std::min(u, 1.0 - u) * projector_output.width,
                    std::min(v, 1.0 - v) * projector_output.height);
}

double distance_to_edge(const ProjectorOutput& projector_output, const glm::dvec3& point) {
    const auto uv = image_coordinates(projector_output.projector, point);
    return uv ? distance_to_edge(projector_output, uv->x, uv->y) : -1.0;
}

// Whether they may overlap: tests whether any of a few dozen points of one is in or near the other's picture.
bool may_overlap(const ProjectorOutput& one, const ProjectorOutput& other) {
    constexpr int Steps = 16;
    const double margin = -2.0 / Steps * std::max({other.width, other.height, one.width, one.height});
    for (int y = 0; y <= Steps; ++y)
        for (int x = 0; x <= Steps; ++x)
            if (distance_to_edge(other, point_at(one.points, double(x) / Steps, double(y) / Steps)) > margin)
                return true;
    return false;
}

// The blend weight of a pixel of one projector, and how many projectors cover it.
struct Coverage {
    double weight = 1.0;
    std::uint8_t count = 1;  // of projectors
};
Coverage coverage_at(const std::vector<ProjectorOutput>& others, const ProjectorOutput& one, std::size_t x,
                     std::size_t y) {
    const double u = (double(x) + 0.5) / one.width, v = (double(y) + 0.5) / one.height;
    const double own = distance_to_edge(one, u, v);
    const glm::dvec3 point = point_at(one.points, u, v);
    Coverage coverage;
    double sum = own * own;
    for (const ProjectorOutput& other : others) {
        const double theirs = distance_to_edge(other, point);
        if (!(theirs > 0.0)) continue;
        sum += theirs * theirs;
        ++coverage.count;
    }
    coverage.weight = own * own / sum;
    return coverage;
}

}  // namespace

std::vector<OverlapMaps> overlap(std::span<const ProjectorOutput> projectors, double black,
                                 tbb::task_arena& arena) {
    std::vector<OverlapMaps> maps(projectors.size());
    std::vector<std::vector<std::uint8_t>> counts(projectors.size());
    for (std::size_t i = 0; i < projectors.size(); ++i) {
        const ProjectorOutput& one = projectors[i];
        std::vector<ProjectorOutput> others;
        for (std::size_t j = 0; j < projectors.size(); ++j)
            if (j != i && may_overlap(one, projectors[j])) others.push_back(projectors[j]);
        maps[i].weights.resize(std::size_t{one.width} * one.height);
        counts[i].resize(maps[i].weights.size());
        parallel_for(arena, one.height, [&](std::size_t y) {
            for (std::size_t x = 0; x < one.width; ++x) {
                const Coverage coverage = coverage_at(others, one, x, y);
                maps[i].weights[y * one.width + x] = static_cast<float>(coverage.weight);
                counts[i][y * one.width + x] = coverage.count;
            }
        });
    }
    if (!(black > 0.0)) return maps;

    std::uint8_t most = 1;
    for (const auto& each : counts)
        for (const std::uint8_t count : each) most = std::max(most, count);
    // Each of `count` projectors adds an equal part of the difference.
    const auto lift = [&](double count) { return (most - count) / count * black / (1.0 - black); };
    const double highest = lift(1.0);
    for (std::size_t i = 0; i < maps.size(); ++i) {
        maps[i].lift.resize(counts[i].size());
        for (std::size_t pixel = 0; pixel < counts[i].size(); ++pixel) {
            const double here = lift(counts[i][pixel]);
            maps[i].lift[pixel] = static_cast<float>(here);
            maps[i].weights[pixel] *= static_cast<float>((1.0 - highest) / (1.0 - here));
        }
    }
    return maps;
}

}  // namespace tessera::display
