// `tessera bench` is a program of its own: when it is meant, and what is said when it is not there.
#include <gtest/gtest.h>

#include <vector>

#include "client/tools/bench.h"

namespace tessera::tools {

namespace {

bool is_bench(std::vector<const char*> words) {
    return names_bench(static_cast<int>(words.size()), words.data());
}

TEST(BenchCommand, IsTheFirstArgumentAfterConfigurationOptions) {
    EXPECT_TRUE(is_bench({"tessera", "bench"}));
    EXPECT_TRUE(is_bench({"tessera", "bench", "filters", "--quick"}));
    EXPECT_TRUE(is_bench({"tessera", "--config", "a.toml", "bench", "live"}));
    EXPECT_TRUE(is_bench({"tessera", "--config=a.toml", "bench"}));
    EXPECT_FALSE(is_bench({"tessera"}));
    EXPECT_FALSE(is_bench({"tessera", "--config"}));
    EXPECT_FALSE(is_bench({"tessera", "--config", "bench"}));
    EXPECT_FALSE(is_bench({"tessera", "render", "bench"}));
}

// There is no tessera-bench in the folder of this test.
TEST(BenchCommand, MissingProgramErrorSaysHowToBuildIt) {
    char name[] = "tessera", bench[] = "bench";
    char* words[] = {name, bench, nullptr};
    testing::internal::CaptureStderr();
    EXPECT_EQ(start_bench(words), cli::ExitUnavailable);
    EXPECT_NE(testing::internal::GetCapturedStderr().find("deploy/setup.sh bench tessera-bench"),
              std::string::npos);
}

}  // namespace

}  // namespace tessera::tools
