#include "mediator/picture/heat_map.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "mediator/picture/color.h"

namespace tessera::picture {
namespace {

double brightness(const frame::Image& image, std::size_t pixel) {
    const auto rgb = image.pixel(pixel);
    return luminance(rgb[0], rgb[1], rgb[2]);
}

TEST(HeatMap, IsBrighterWhereValuesAreLarger) {
    std::vector<float> values;
    for (int i = 0; i <= 200; ++i) values.push_back(0.01f * std::pow(100.0f, float(i) / 200.0f));
    const frame::Image map = heat_map(values, 201, 1, 0.01f, 1.0f);
    for (std::size_t i = 1; i < values.size(); ++i)
        EXPECT_GT(brightness(map, i), brightness(map, i - 1)) << i;
    EXPECT_EQ(brightness(map, 0), 0.0);
    EXPECT_NEAR(brightness(map, 200), 1.0, 1e-5);
    const auto middle = map.pixel(100);  // 0.1
    EXPECT_GT(middle[0], 4.0f * middle[1]) << "red";
    EXPECT_GT(middle[0], 2.0f * middle[2]);
}

TEST(HeatMap, EndsAtItsLimits) {
    const float infinity = std::numeric_limits<float>::infinity();
    const std::vector<float> values{0.0f, -1.0f, 1e-30f, std::nanf(""), -infinity, 1.0f, 5.0f, infinity};
    const frame::Image map = heat_map(values, 4, 2, 0.01f, 1.0f);
    for (std::size_t i = 0; i < 8; ++i) EXPECT_NEAR(brightness(map, i), i < 5 ? 0.0 : 1.0, 1e-5) << values[i];
}

}  // namespace
}  // namespace tessera::picture
