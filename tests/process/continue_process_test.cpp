// `tessera render --continue`: a film file that goes on.
#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <thread>

#include "mediator/picture/exr_reader.h"
#include "tests/process/real_cluster.h"

namespace tessera::test {
namespace {

const std::vector<std::string> View{"--size", "64x48", "--seed", "5", "--save-statistics"};

struct ContinuedRender : testing::Test {
    TemporaryFolder folder;
    std::string scene = scene_file("room-1.glb");

    nlohmann::json whole(const std::string& label, std::vector<std::string> options) {
        options.insert(options.end(), View.begin(), View.end());
        return render_embedded(folder, label, scene, options);
    }
    // The size and the seed are those of the film.
    nlohmann::json continued(const std::string& label, const std::string& film,
                             std::vector<std::string> options) {
        options.insert(options.end(), {"--continue", folder / (film + ".exr"), "--save-statistics"});
        return render_embedded(folder, label, scene, options);
    }
    int code_of(std::vector<std::string> options, std::string* output = nullptr) {
        options.insert(options.begin(), {"render", scene, "-o", folder / "x.exr"});
        ChildProcess process(folder.path(), "x", "tessera", options);
        const int code = process.wait(std::chrono::minutes(2)).value_or(-1);
        if (output != nullptr) *output = process.out() + process.err();
        return code;
    }
};

TEST_F(ContinuedRender, EndsWithTheBitsOfOneRun) {
    const nlohmann::json expected = whole("whole", {"--spp", "64"});
    whole("part", {"--spp", "12"});
    continued("more", "part", {"--spp", "48"});
    const nlohmann::json last = continued("last", "more", {"--spp", "64"});
    EXPECT_EQ(last["film_hash"], expected["film_hash"]);
    EXPECT_EQ(last["samples_before"], 48 * 64 * 48);
    EXPECT_EQ(last["spp"], 64);
    RealCluster cluster;
    const ChildProcess node = cluster.start_node("a");
    const nlohmann::json remote = cluster.render(
        "remote", scene, {"--continue", folder / "part.exr", "--spp", "64", "--save-statistics"});
    EXPECT_EQ(remote["film_hash"], expected["film_hash"]);
}

TEST_F(ContinuedRender, ReachesANoiseAfterATime) {
    const nlohmann::json part = whole("part", {"--time", "2s", "--spp", "4096"});
    const nlohmann::json last = continued("last", "part", {"--noise", "0.2"});
    EXPECT_LE(last["noise"], 0.2);
    EXPECT_GE(last["samples_before"], 64 * 48);
}

TEST_F(ContinuedRender, GoesOnAfterAnInterrupt) {
    const nlohmann::json expected = whole("whole", {"--noise", "0.08"});
    std::vector<std::string> options{"render", scene, "-o", folder / "part.exr", "--noise", "0.08"};
    options.insert(options.end(), View.begin(), View.end());
    int code = 0;
    // It may end before the interrupt, or have nothing yet.
    for (int tenths = 20; tenths > 0 && code != 130; tenths -= 3) {
        ChildProcess process(folder.path(), "part", "tessera", options);
        std::this_thread::sleep_for(std::chrono::milliseconds(100 * tenths));
        process.signal(SIGINT);
        code = process.wait(std::chrono::minutes(1)).value_or(-1);
    }
    ASSERT_EQ(code, 130);
    ASSERT_TRUE(std::filesystem::exists(folder / "part.exr"));
    EXPECT_EQ(continued("last", "part", {"--noise", "0.08"})["film_hash"], expected["film_hash"]);
}

TEST_F(ContinuedRender, RefusesWhatIsNotItsFilm) {
    whole("part", {"--spp", "8"});
    render_embedded(folder, "bare", scene, {"--size", "64x48", "--spp", "2"});
    const std::string film = folder / "part.exr";
    std::string said;
    const auto expect = [&](int code, const std::string& text, std::vector<std::string> options) {
        EXPECT_EQ(code_of(std::move(options), &said), code) << said;
        EXPECT_NE(said.find(text), std::string::npos) << said;
    };
    expect(64, "until when", {"--continue", film});
    expect(64, "8 samples per pixel already", {"--continue", film, "--spp", "8"});
    expect(64, "--size", {"--continue", film, "--spp", "16", "--size", "32x24"});
    expect(64, "--seed", {"--continue", film, "--spp", "16", "--seed", "6"});
    expect(2, "no such file", {"--continue", folder / "missing.exr", "--spp", "16"});
    expect(2, "save-statistics", {"--continue", folder / "bare.exr", "--spp", "16"});
    scene = scene_file("studio-1.glb");
    expect(77, "another scene", {"--continue", film, "--spp", "16"});
    EXPECT_FALSE(std::filesystem::exists(folder / "x.exr"));
}

}  // namespace
}  // namespace tessera::test
