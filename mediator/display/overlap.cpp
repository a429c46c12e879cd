#include "mediator/display/overlap.h"

#include <algorithm>

#include "mediator/base/parallel.h"
#include "mediator/display/grid_places.h"
#include "mediator/display/projector.h"

namespace tessera::display {

namespace {

// Pixels to the nearest edge of the picture; not positive outside.
double distance_to_edge(const Thrower& thrower, double u, double v) {
    return std::min(std::min(u, 1.0 - u) * thrower.width, std::min(v, 1.0 - v) * thrower.height);
}

double distance_to_edge(const Thrower& thrower, const glm::dvec3& point) {
    const auto place = place_in_picture(thrower.projector, point);
    return place ? distance_to_edge(thrower, place->x, place->y) : -1.0;
}

// Whether they may overlap: some of a few dozen points of one lie in the other's picture or close to it.
bool may_meet(const Thrower& one, const Thrower& other) {
    constexpr int Steps = 16;
    const double margin = -2.0 / Steps * std::max({other.width, other.height, one.width, one.height});
    for (int y = 0; y <= Steps; ++y)
        for (int x = 0; x <= Steps; ++x)
            if (distance_to_edge(other, point_at(one.points, double(x) / Steps, double(y) / Steps)) > margin)
                return true;
    return false;
}

// What meets a pixel of one projector.
struct Meeting {
    double weight = 1.0;
    std::uint8_t count = 1;  // of projectors
};
Meeting meet(const std::vector<Thrower>& others, const Thrower& one, std::size_t x, std::size_t y) {
    const double u = (double(x) + 0.5) / one.width, v = (double(y) + 0.5) / one.height;
    const double own = distance_to_edge(one, u, v);
    const glm::dvec3 point = point_at(one.points, u, v);
    Meeting meeting;
    double sum = own * own;
    for (const Thrower& other : others) {
        const double theirs = distance_to_edge(other, point);
        if (!(theirs > 0.0)) continue;
        sum += theirs * theirs;
        ++meeting.count;
    }
    meeting.weight = own * own / sum;
    return meeting;
}

}  // namespace

std::vector<OverlapMaps> overlap(std::span<const Thrower> throwers, double black, tbb::task_arena& arena) {
    std::vector<OverlapMaps> maps(throwers.size());
    std::vector<std::vector<std::uint8_t>> counts(throwers.size());
    for (std::size_t i = 0; i < throwers.size(); ++i) {
        const Thrower& one = throwers[i];
        std::vector<Thrower> others;
        for (std::size_t j = 0; j < throwers.size(); ++j)
            if (j != i && may_meet(one, throwers[j])) others.push_back(throwers[j]);
        maps[i].weights.resize(std::size_t{one.width} * one.height);
        counts[i].resize(maps[i].weights.size());
        parallel_for(arena, one.height, [&](std::size_t y) {
            for (std::size_t x = 0; x < one.width; ++x) {
                const Meeting meeting = meet(others, one, x, y);
                maps[i].weights[y * one.width + x] = static_cast<float>(meeting.weight);
                counts[i][y * one.width + x] = meeting.count;
            }
        });
    }
    if (!(black > 0.0)) return maps;

    std::uint8_t most = 1;
    for (const auto& each : counts)
        for (const std::uint8_t count : each) most = std::max(most, count);
    // Of `count` projectors each adds an equal share of what is missing.
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
