#include "tests/filter/consistency.h"

#include <gtest/gtest.h>

namespace tessera::filter {
namespace {

class Consistency : public testing::TestWithParam<std::string> {};

TEST_P(Consistency, NeverWorsensAPicture) {
    for (std::uint64_t n = 4; n <= 4096; n *= 4) {
        EXPECT_LE(error_ratio(GetParam(), ConsistencyScene::ShadowedTexture, n), 1.05) << n;
        EXPECT_LE(error_ratio(GetParam(), ConsistencyScene::LightTexture, n), 1.05) << n;
    }
}

INSTANTIATE_TEST_SUITE_P(Filters, Consistency, testing::Values("pixel", "statmc", "nfor"),
                         [](const auto& tested) { return tested.param; });

}  // namespace
}  // namespace tessera::filter
