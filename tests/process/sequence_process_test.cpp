// Sequences: one import, one edit per frame, bit-identical to frames rendered separately.
#include <gtest/gtest.h>
#include <signal.h>

#include <sstream>
#include <thread>

#include "mediator/picture/exr_reader.h"
#include "tests/import/animated_file.h"
#include "tests/process/real_cluster.h"

namespace tessera::test {
namespace {

using nlohmann::json;

constexpr std::chrono::minutes SequencePatience(3);

std::string moving_scene(const import::TestFolder& folder) {
    return folder.write("moving.glb", import::moving_file().glb()).string();
}

// The film of each frame, by its number.
std::map<int, std::string> hashes(const std::string& lines) {
    std::map<int, std::string> found;
    std::istringstream stream(lines);
    for (std::string line; std::getline(stream, line);) {
        const json object = json::parse(line, nullptr, false);
        EXPECT_TRUE(object.contains("frame")) << line;
        if (object.contains("frame")) found[object["frame"].get<int>()] = object["film_hash"];
    }
    return found;
}

TEST(SequenceProcess, ClusterFramesMatchSingleFramesBitwise) {
    const import::TestFolder files;
    const std::string scene = moving_scene(files);
    RealCluster cluster;
    const ChildProcess a = cluster.start_node("a"), b = cluster.start_node("b");
    ChildProcess render = cluster.start_render("frame.%02d", scene,
                                               {"--size", "64x48", "--spp", "4", "--seed", "7", "--frames",
                                                "1:4", "--fps", "2", "--wait-nodes", "2:60", "--json"});
    ASSERT_EQ(render.wait(SequencePatience).value_or(-1), 0) << render.err();
    const auto together = hashes(render.out());
    ASSERT_EQ(together.size(), 4u) << render.out();
    for (int frame = 1; frame <= 4; ++frame) {
        const json alone = render_embedded(cluster.folder(), "alone", scene,
                                           {"--size", "64x48", "--spp", "4", "--seed",
                                            std::to_string(7 + frame), "--at", std::to_string(frame / 2.0)});
        EXPECT_EQ(alone["film_hash"], together.at(frame)) << frame;
        EXPECT_NO_THROW(picture::read_exr(cluster.folder() / ("frame.0" + std::to_string(frame) + ".exr")));
    }
    EXPECT_NE(together.at(1), together.at(2));
}

// `auto` is measured once, of the first frame, so that brightness does not pump; independent of who encodes the pictures.
TEST(SequenceProcess, HasTheExposureOfItsFirstFrame) {
    const import::TestFolder files;
    const TemporaryFolder folder;
    const std::string scene = moving_scene(files);
    const auto exposures = [&](const std::string& frames, const std::vector<std::string>& more) {
        std::vector<std::string> arguments{"render", scene, "--size",   "64x48", "--spp", "4",
                                           "--fps",  "2",   "--frames", frames,  "-o",    folder / "f.%d.png",
                                           "--json"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        ChildProcess render(folder.path(), "frames", "tessera", arguments);
        EXPECT_EQ(render.wait(SequencePatience).value_or(-1), 0) << render.err();
        std::vector<double> found;
        std::istringstream lines(render.out());
        for (std::string line; std::getline(lines, line);)
            found.push_back(json::parse(line)["exposure"].get<double>());
        return found;
    };
    for (const std::vector<std::string>& more : {std::vector<std::string>{}, {"--filter", "none"}}) {
        const auto together = exposures("0:3", more);
        ASSERT_EQ(together.size(), 4u);
        EXPECT_EQ(together, std::vector<double>(4, together.front()));
        EXPECT_NE(exposures("3:3", more).at(0), together.front()) << "nothing has changed in the picture";
    }
    EXPECT_EQ(exposures("0:1", {"--exposure", "-1.5"}), (std::vector<double>{-1.5, -1.5}));
}

// With more tiles than the master processes at once.
TEST(BigPictureProcess, ArrivesComplete) {
    const import::TestFolder files;
    const TemporaryFolder folder;
    const json done = render_embedded(folder, "big", moving_scene(files),
                                      {"--size", "1600x1200", "--spp", "1", "--backend", "null"});
    EXPECT_EQ(done["rays"].get<std::uint64_t>(), 1600u * 1200u);  // one a sample
}

TEST(SequenceProcess, InterruptedSequenceKeepsCompleteFramesAndResumes) {
    const import::TestFolder files;
    const TemporaryFolder folder;
    const std::string pattern = folder / "frame.%d.exr";
    std::vector<std::string> arguments{"render", moving_scene(files), "--size", "320x240", "--spp",
                                       "16",     "--frames",          "0:99",   "-o",      pattern,
                                       "--json"};
    ChildProcess render(folder.path(), "first", "tessera", arguments);
    const auto deadline = std::chrono::steady_clock::now() + SequencePatience;
    while (!std::filesystem::exists(folder / "frame.1.exr") && std::chrono::steady_clock::now() < deadline)
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
    render.signal(SIGINT);
    ASSERT_EQ(render.wait(SequencePatience).value_or(-1), 130) << render.err();
    const auto there = hashes(render.out());
    EXPECT_NE(render.err().find("interrupted; the earlier frames were written"), std::string::npos)
        << render.err();
    ASSERT_LT(there.size(), 100u);
    for (int frame = 0; frame < 100; ++frame) {
        const std::filesystem::path file = folder / ("frame." + std::to_string(frame) + ".exr");
        ASSERT_EQ(std::filesystem::exists(file), there.contains(frame)) << frame;
        if (!there.contains(frame)) continue;
        EXPECT_NO_THROW(picture::read_exr(file.string())) << frame;
    }

    const int next = static_cast<int>(there.size());
    arguments[7] = "0:" + std::to_string(next + 1);
    arguments.emplace_back("--skip-existing");
    ChildProcess rest(folder.path(), "rest", "tessera", arguments);
    ASSERT_EQ(rest.wait(SequencePatience).value_or(-1), 0) << rest.err();
    const auto added = hashes(rest.out());
    EXPECT_EQ(added.size(), 2u);
    EXPECT_TRUE(added.contains(next) && added.contains(next + 1)) << rest.out();
}

TEST(SequenceProcess, SceneWithoutAnimationIsAnError) {
    const TemporaryFolder folder;
    ChildProcess render(
        folder.path(), "still", "tessera",
        {"render", scene_file("still.glb"), "--frames", "0:3", "-o", folder / "still.%d.png"});
    EXPECT_EQ(render.wait(SequencePatience).value_or(-1), 2);
    EXPECT_NE(render.err().find("the scene has no animation"), std::string::npos) << render.err();
}

}  // namespace
}  // namespace tessera::test
