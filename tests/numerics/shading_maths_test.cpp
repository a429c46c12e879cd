// The error bounds stated in mediator/shading/maths.h, checked against double.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "mediator/shading/maths.h"

namespace tessera::shading {
namespace {

// Of the float nearest to a number.
double ulp_of(double exact) {
    int exponent = 0;
    std::frexp(exact, &exponent);
    return std::ldexp(1.0, std::max(exponent - 24, -149));
}

struct OfOne {
    const char* name;
    float (*ours)(float);
    double (*exact)(double);
    float first, last;  // of one sign
    double bound;       // ulp
};
void PrintTo(const OfOne& c, std::ostream* out) {
    *out << c.name << " from " << c.first << " to " << c.last;
}

class MathsOfOne : public testing::TestWithParam<OfOne> {};

// Every 997th float, so that all exponents and ends of intervals are met.
TEST_P(MathsOfOne, StaysWithinItsErrorBound) {
    const OfOne& c = GetParam();
    double worst = 0.0;
    float at = c.first;
    for (uint bits = float_bits(c.first); bits <= float_bits(c.last); bits += 997) {
        const float x = float_from_bits(bits);
        const double exact = c.exact(double(x));
        const double error = std::fabs(double(c.ours(x)) - exact) / ulp_of(exact);
        if (!(error <= worst)) worst = error, at = x;
    }
    RecordProperty("ulp", std::to_string(worst));
    EXPECT_LE(worst, c.bound) << "at " << at;
}

INSTANTIATE_TEST_SUITE_P(
    Table, MathsOfOne,
    testing::Values(OfOne{"sine", sine, std::sin, 0.0f, 1e4f, 3.0},
                    OfOne{"sine", sine, std::sin, -0.0f, -1e4f, 3.0},
                    OfOne{"sine", sine, std::sin, 0.0f, 10.0f, 2.0},
                    OfOne{"cosine", cosine, std::cos, 0.0f, 1e4f, 3.0},
                    OfOne{"cosine", cosine, std::cos, -0.0f, -1e4f, 3.0},
                    OfOne{"cosine", cosine, std::cos, 0.0f, 10.0f, 2.0},
                    OfOne{"exponential", exponential, std::exp, 0.0f, 88.7228f, 1.0},
                    OfOne{"exponential", exponential, std::exp, -0.0f, -110.0f, 1.0},
                    OfOne{"logarithm", logarithm, std::log, 0x1p-126f, 0x1.fffffep127f, 1.0},
                    OfOne{"inverse_sqrt", inverse_sqrt, [](double x) { return 1.0 / std::sqrt(x); },
                          0x1p-125f, 0x1p127f, 2.0}));

// all combinations of magnitudes of x and y.
template <class Check>
void for_random_pairs(float exponents, const Check& check) {
    std::mt19937 random(1);
    std::uniform_real_distribution<float> exponent(-exponents, exponents), mantissa(-1.0f, 1.0f);
    for (int i = 0; i < 300'000; ++i) {
        const float x = mantissa(random) * std::exp2(exponent(random));
        check(x, mantissa(random) * std::exp2(exponent(random)));
    }
}

TEST(Maths, ArcTangentStaysWithinItsErrorBound) {
    double worst = 0.0;
    for (const float exponents : {1.0f, 60.0f}) {
        for_random_pairs(exponents, [&](float x, float y) {
            const double exact = std::atan2(double(y), double(x));
            worst = std::fmax(worst, std::fabs(double(arc_tangent(y, x)) - exact) / ulp_of(exact));
        });
    }
    EXPECT_LE(worst, 3.0);
    EXPECT_EQ(arc_tangent(0.0f, 0.0f), 0.0f);
    EXPECT_EQ(arc_tangent(0.0f, -1.0f), 3.14159274f);
    EXPECT_EQ(arc_tangent(-1.0f, 0.0f), -1.57079637f);
    EXPECT_EQ(arc_tangent(0.0f, 1.0f), 0.0f);
}

TEST(Maths, PowerStaysWithinItsErrorBound) {
    double worst = 0.0;
    for_random_pairs(3.0f, [&](float x, float y) {
        x = std::fabs(x);
        const double size = std::fabs(double(y) * std::log(double(x)));
        if (size > 87.0) return;
        const double exact = std::pow(double(x), double(y));
        worst = std::fmax(worst, std::fabs(double(power(x, y)) - exact) / ulp_of(exact) / (2.0 + 2.0 * size));
    });
    EXPECT_LE(worst, 1.0);
    EXPECT_EQ(power(0.0f, 2.4f), 0.0f);
    EXPECT_EQ(power(0.0f, 0.0f), 1.0f);
    EXPECT_EQ(power(1.0f, 1e9f), 1.0f);
}

TEST(Maths, LimitsAreAsDocumented) {
    EXPECT_EQ(exponential(0.0f), 1.0f);
    EXPECT_EQ(exponential(100.0f), infinity());
    EXPECT_EQ(exponential(-infinity()), 0.0f);
    EXPECT_EQ(logarithm(1.0f), 0.0f);
    EXPECT_EQ(logarithm(0.0f), -infinity());
    EXPECT_EQ(logarithm(-1.0f), -infinity());
    EXPECT_EQ(unit_vector(vec3(0.0f)), vec3(0.0f));
}

TEST(Maths, UnitVectorsHaveUnitLength) {
    for_random_pairs(30.0f, [&](float x, float y) {
        const vec3 v(x, y, 0.5f * (x + y)), unit = unit_vector(v);
        const double length = std::sqrt(double(v.x) * v.x + double(v.y) * v.y + double(v.z) * v.z);
        for (int i = 0; i < 3; ++i) {
            // The bound of inverse_sqrt, half of the 2 ulp of the squares' sum, and the product's rounding.
            ASSERT_LE(std::fabs(double(unit[i]) - double(v[i]) / length) / ulp_of(double(v[i]) / length),
                      2.0 * 2.0 + 1.0 + 0.5)
                << x << " " << y;
        }
    });
}

}  // namespace
}  // namespace tessera::shading
