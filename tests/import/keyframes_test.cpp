#include "client/import/keyframes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>

#include "mediator/base/error.h"

namespace tessera::import {
namespace {

double at(const KeyTrack& track, double seconds) {
    double value = 0.0;
    sample(track, seconds, {&value, 1});
    return value;
}

TEST(Keyframes, StepInterpolationHoldsThePreviousKey) {
    const KeyTrack track{.interpolation = Interpolation::Step, .times = {1, 2, 4}, .values = {10, 20, 40}};
    EXPECT_EQ(at(track, -3.0), 10.0);
    EXPECT_EQ(at(track, 1.999), 10.0);
    EXPECT_EQ(at(track, 2.0), 20.0);
    EXPECT_EQ(at(track, 3.999), 20.0);
    EXPECT_EQ(at(track, 4.0), 40.0);
    EXPECT_EQ(at(track, 99.0), 40.0);
}

TEST(Keyframes, LinearInterpolationIsConstantBeyondTheEnds) {
    const KeyTrack track{.times = {1, 2, 4}, .values = {10, 20, 0}};
    EXPECT_EQ(at(track, 0.0), 10.0);
    EXPECT_DOUBLE_EQ(at(track, 1.25), 12.5);
    EXPECT_DOUBLE_EQ(at(track, 3.5), 5.0);
    EXPECT_EQ(at(track, 5.0), 0.0);
    EXPECT_EQ(at({.times = {3}, .values = {7}}, 0.0), 7.0) << "one key is a constant";
}

// At t = 1/4 the Hermite basis is 27/32, 9/64, 5/32, -3/64; tangents count times the 2 seconds.
TEST(Keyframes, SplinesFollowTheirTangents) {
    const KeyTrack track{
        .interpolation = Interpolation::CubicSpline, .times = {1, 3}, .values = {99, 2, 3, -1, 5, 99}};
    EXPECT_DOUBLE_EQ(at(track, 1.5), 27.0 / 32 * 2 + 2 * 9.0 / 64 * 3 + 5.0 / 32 * 5 + 2 * 3.0 / 64);
    EXPECT_EQ(at(track, 1.0), 2.0);
    EXPECT_EQ(at(track, 3.0), 5.0);
    EXPECT_EQ(at(track, 7.0), 5.0);
    constexpr double H = 1e-6;
    EXPECT_NEAR((at(track, 1.0 + H) - at(track, 1.0)) / H, 3.0, 1e-4) << "the out-tangent of the first key";
    EXPECT_NEAR((at(track, 3.0) - at(track, 3.0 - H)) / H, -1.0, 1e-4) << "the in-tangent of the second";
}

KeyTrack turns(std::vector<float> values, Interpolation interpolation = Interpolation::Linear) {
    return {.interpolation = interpolation, .width = 4, .times = {0, 3}, .values = std::move(values)};
}

void expect_turn_about_y(const glm::dvec4& rotation, double degrees) {
    const double half = degrees * std::numbers::pi / 360.0;
    EXPECT_NEAR(glm::distance(rotation, {0.0, std::sin(half), 0.0, std::cos(half)}), 0.0, 1e-7) << degrees;
}

TEST(Keyframes, RotationsUseSlerpAlongTheShorterArc) {
    const float half = std::numbers::sqrt2_v<float> / 2;
    for (const float sign : {1.0f, -1.0f}) {  // q and -q are one rotation
        const KeyTrack quarter = turns({0, 0, 0, 1, 0, sign * half, 0, sign * half});
        for (const double seconds : {0.0, 1.0, 2.0, 3.0})
            expect_turn_about_y(sample_rotation(quarter, seconds) * (seconds == 3.0 ? double(sign) : 1.0),
                                30.0 * seconds);
    }
    expect_turn_about_y(sample_rotation(turns({0, 0, 0, 1, 0, 0, 0, 1}), 1.5), 0.0);
    expect_turn_about_y(sample_rotation(turns({0, 0, 0, 2, 0, 1e-10f, 0, 3}), 1.5), 0.0);
}

TEST(Keyframes, SplineRotationsAreNormalizedEvenThroughZero) {
    const KeyTrack through_zero =
        turns({0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, -1, 0, 0, 0, 0},
              Interpolation::CubicSpline);
    expect_turn_about_y(sample_rotation(through_zero, 1.5), 0.0);
    const KeyTrack track = turns({0, 0, 0, 0, 0, 0, 0, 1, 0, 1, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0},
                                 Interpolation::CubicSpline);
    for (const double seconds : {0.0, 0.7, 1.9, 3.0})
        EXPECT_NEAR(glm::length(sample_rotation(track, seconds)), 1.0, 1e-12);
}

std::string cause(const KeyTrack& track) {
    try {
        track.width == 4 ? check_rotation(track) : check(track);
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::InvalidInput);
        return error.what();
    }
    return "fine";
}

TEST(Keyframes, InvalidTracksAreRejected) {
    constexpr float Infinity = std::numeric_limits<float>::infinity(),
                    NaN = std::numeric_limits<float>::quiet_NaN();
    using testing::HasSubstr;
    EXPECT_EQ(cause({.times = {0, 1}, .values = {0, 1}}), "fine");
    EXPECT_THAT(cause({}), HasSubstr("no keys"));
    EXPECT_THAT(cause({.times = {0, 0}, .values = {0, 1}}), HasSubstr("key 1 is not after"));
    EXPECT_THAT(cause({.times = {0, 2, 1}, .values = {0, 1, 2}}), HasSubstr("key 2 is not after"));
    EXPECT_THAT(cause({.times = {NaN}, .values = {0}}), HasSubstr("not finite"));
    EXPECT_THAT(cause({.times = {0, Infinity}, .values = {0, 1}}), HasSubstr("not finite"));
    EXPECT_THAT(cause({.times = {0, 1}, .values = {0}}), HasSubstr("1 values, but 2 keys need 2"));
    EXPECT_THAT(cause({.interpolation = Interpolation::CubicSpline, .times = {0}, .values = {0}}),
                HasSubstr("need 3"));
    EXPECT_THAT(cause({.times = {0}, .values = {NaN}}), HasSubstr("not finite"));
    EXPECT_THAT(cause({.times = {0}, .values = {1e20f}}), HasSubstr("beyond"));
    EXPECT_THAT(cause(turns({0, 0, 0, 1, 0, 0, 0, 0})), HasSubstr("key 1 is not a quaternion"));
}

}  // namespace
}  // namespace tessera::import
