#include "master/render/adaptive/filtered_error.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "master/filter/catalog.h"
#include "mediator/filter/inputs.h"
#include "mediator/picture/brightness.h"

namespace tessera::master {

namespace {

using frame::Channel;
using picture::PixelRows;

constexpr std::size_t DeviationRadius = 4;

filter::Planes& radiance(std::array<filter::Planes, frame::ChannelCount>& planes) {
    return planes[static_cast<std::size_t>(Channel::Radiance)];
}

// `half` of the samples of `all`, as if there were no others. Features keep all of theirs, which have little noise.
void take_half(const filter::Inputs& all, std::size_t half, filter::Inputs& into) {
    const std::span<const float> count = all.counts.plane(0), part = all.half_counts[half].plane(0);
    std::ranges::copy(part, into.counts.plane(0).begin());
    std::ranges::copy(all.halves[half].values(), radiance(into.means).values().begin());
    for (std::uint32_t c = 0; c < 3; ++c) {
        const std::span<const float> variance = all.variance(Channel::Radiance).plane(c);
        const std::span<float> of_half = radiance(into.variances).plane(c);
        for (std::size_t i = 0; i < variance.size(); ++i)
            of_half[i] = part[i] > 0.0f ? variance[i] * count[i] / part[i] : 0.0f;
    }
}

// Of the mean of the pictures of both halves, over the pixels and components. That of `bias` contains the variance once more.
struct Sums {
    double variance = 0.0, bias = 0.0, variance_in_bias = 0.0;
};

}  // namespace

FilteredError::FilteredError(const frame::FilmTile& film, const view::View& view,
                             const filter::Choice& choice, tbb::task_arena& arena) {
    const filter::Inputs all = filter::make_inputs(film, view);
    filter::Inputs half = all;
    for (filter::Planes& unused : half.halves) unused = {};
    std::array<filter::Planes, 2> filtered;
    {
        const auto filter = choice.entry->make(all.width, all.height);
        filter::Output output;
        for (std::size_t h = 0; h < 2; ++h) {
            take_half(all, h, half);
            filter->reset();
            filter->run(half, choice.values, output, {arena, {}});
            filtered[h] = output.picture;
        }
    }
    const PixelRows rows{all.width, all.height, &arena};
    const std::size_t pixels = all.pixel_count();
    std::vector<float> known(pixels);
    double count = 0.0;
    for (std::size_t i = 0; i < pixels; ++i) {
        known[i] = film.counts[i] >= 2 ? 1.0f : 0.0f;
        count += known[i];
    }
    if (count == 0.0) return;
    const float floor = picture::brightness_floor(film);
    picture::Brightness brightness(rows, known);
    std::vector<float> finite(pixels);
    Sums sums;
    deviations_.assign(pixels, 0.0f);
    for (std::uint32_t c = 0; c < 3; ++c) {
        const std::span<const float> variance = all.variance(Channel::Radiance).plane(c);
        for (std::size_t i = 0; i < pixels; ++i) finite[i] = known[i] * std::min(variance[i], 1e30f);
        brightness.estimate(all.color(c), finite);
        const std::span<const float> square = brightness.of_others();
        const std::span<const float> first = filtered[0].plane(c), second = filtered[1].plane(c);
        const std::span<const float> u = all.halves[0].plane(c), v = all.halves[1].plane(c);
        for (std::size_t i = 0; i < pixels; ++i) {
            if (known[i] == 0.0f) continue;
            const double f = first[i], g = second[i], mean = 0.5 * (f + g);
            const double of_mean = 0.25 * (f - g) * (f - g);
            const double relative = of_mean / (3.0 * (double(square[i]) + floor));
            const double weight = 1.0 / (3.0 * (std::max(0.0, f * g) + floor));
            sums.variance += relative;
            sums.bias += weight * (mean * mean - f * v[i] - g * u[i] + double(u[i]) * v[i]);
            sums.variance_in_bias += weight * of_mean;
            deviations_[i] += static_cast<float>(relative * film.counts[i]);
        }
    }
    const double bias = std::max(0.0, sums.bias - sums.variance_in_bias);
    relmse_ = (bias + 2.0 * sums.variance) / count;
    for (float& deviation : deviations_) deviation = std::sqrt(deviation);
    picture::SquareSum squares(rows);
    squares.apply(deviations_, DeviationRadius);
    squares.apply(known, DeviationRadius);
    for (std::size_t i = 0; i < pixels; ++i) deviations_[i] /= std::max(known[i], 1.0f);
}

double part_to_reach(double wanted, double error) {
    // That of `fdf` falls with n^-0.89 from 4 to 16 samples, and with n^-0.77 from 16 to 64: geometric means over the scenes of
    // tessera bench filters.
    constexpr double Exponent = 0.8;
    constexpr double LargestPart = 0.9;  // a step has to lead somewhere
    if (error <= wanted) return 1.0;
    return std::min(std::pow(wanted / error, 1.0 / Exponent), LargestPart);
}

Step next_step_to(const ErrorGoal& goal, const frame::FilmTile& film, std::span<const std::uint8_t> doublings,
                  std::span<const Rect> tiles, AdaptiveSettings settings, tbb::task_arena& arena) {
    const auto choice = filter::parse_choice(goal.view.filter, filter::catalog());
    if (!choice) throw choice.error();
    settings.part = 0.0;
    if (choice->entry == &filter::catalog().front()) {  // none
        settings.noise = std::sqrt(goal.error);
        Step step = next_step(film, doublings, tiles, settings, &arena);
        step.error = step.noise * step.noise;
        return step;
    }
    const FilteredError error(film, goal.view, *choice, arena);
    settings.part = part_to_reach(goal.error, error.relmse());
    Step step = next_step(film, doublings, tiles, settings, &arena, error.deviations());
    step.error = error.relmse();
    return step;
}

}  // namespace tessera::master
