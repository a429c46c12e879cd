#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <glm/vec3.hpp>
#include <vector>

#include "mediator/base/random.h"

// Chi-squared tests of directions.
namespace tessera::test {

inline constexpr double DoublePi = 3.14159265358979323846;

// Largest plausible chi-squared with k degrees of freedom: 5 standard deviations of its cube root (Wilson and
// Hilferty 1931), one in a million for each of some thirty tests.
inline double critical(double k) {
    const double c = 2.0 / (9.0 * k);
    return k * std::pow(1.0 - c + 5.0 * std::sqrt(c), 3.0);
}

inline void expect_fit(const std::vector<double>& observed, const std::vector<double>& expected) {
    double statistic = 0.0, pooled_observed = 0.0, pooled_expected = 0.0;
    int cells = 0;
    for (std::size_t i = 0; i < observed.size(); ++i) {
        if (expected[i] < 5.0) {  // too few for the statistic: pooled
            pooled_observed += observed[i];
            pooled_expected += expected[i];
            continue;
        }
        statistic += (observed[i] - expected[i]) * (observed[i] - expected[i]) / expected[i];
        ++cells;
    }
    if (pooled_expected > 5.0) {
        statistic +=
            (pooled_observed - pooled_expected) * (pooled_observed - pooled_expected) / pooled_expected;
        ++cells;
    } else {
        EXPECT_LT(pooled_observed, 40.0) << "samples where the density is nearly 0";
    }
    EXPECT_LT(statistic, critical(cells - 1)) << cells << " cells";
}

inline constexpr int Rows = 24, Columns = 24, Samples = 200'000;

inline std::size_t cell(const glm::vec3& w) {
    const double phi = std::atan2(double(w.y), double(w.x)) / (2.0 * DoublePi) + 0.5;
    const int row = std::min(Rows - 1, static_cast<int>((double(w.z) + 1.0) / 2.0 * Rows));
    const int column = std::min(Columns - 1, static_cast<int>(phi * Columns));
    return static_cast<std::size_t>(row * Columns + column);
}

// Integrates the density over cells equal in cos theta and phi, by midpoints fine enough for the narrowest
// lobe here.
inline std::vector<double> integrate(const std::function<double(const glm::vec3&)>& pdf) {
    constexpr int Fine = 40;
    std::vector<double> cells(Rows * Columns);
    for (int r = 0; r < Rows * Fine; ++r) {
        const double z = -1.0 + 2.0 * (r + 0.5) / (Rows * Fine), s = std::sqrt(1.0 - z * z);
        for (int c = 0; c < Columns * Fine; ++c) {
            const double phi = 2.0 * DoublePi * ((c + 0.5) / (Columns * Fine) - 0.5);
            const glm::vec3 w(s * std::cos(phi), s * std::sin(phi), z);
            cells[static_cast<std::size_t>(r / Fine * Columns + c / Fine)] += pdf(w);
        }
    }
    const double step = 4.0 * DoublePi / (double(Rows) * Columns * Fine * Fine);
    for (double& value : cells) value *= step;
    return cells;
}

// Whether samples can fail, returning (0, 0, 0): they are counted in a separate cell with the remaining probability.
enum class Losses { None, Allowed };

inline void expect_directions(const std::function<glm::vec3(CounterRandom&)>& sample,
                              const std::function<double(const glm::vec3&)>& pdf,
                              Losses losses = Losses::None) {
    CounterRandom random(5);
    std::vector<double> observed(Rows * Columns + 1), expected = integrate(pdf);
    double found = 0.0;
    for (double& value : expected) {
        found += value;
        value *= Samples;
    }
    EXPECT_LE(found, 1.002);
    expected.push_back(losses == Losses::Allowed ? (1.0 - std::min(found, 1.0)) * Samples : 0.0);
    for (int i = 0; i < Samples; ++i) {
        const glm::vec3 w = sample(random);
        ++observed[w == glm::vec3(0.0f) ? observed.size() - 1 : cell(w)];
    }
    expect_fit(observed, expected);
}

}  // namespace tessera::test
