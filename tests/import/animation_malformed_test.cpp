#include "mediator/base/random.h"
#include "tests/import/animated_file.h"
#include "tests/import/inspect.h"

// Malformed animations and skins are skipped with a notice while the rest is rendered and animated; nothing
// does worse than an error.
namespace tessera::import {
namespace {

using testing::HasSubstr;

std::string replaced(std::string text, const std::string& from, const std::string& to) {
    const std::size_t place = text.find(from);
    if (place == std::string::npos) ADD_FAILURE() << "the file has no " << from;
    return place == std::string::npos ? text : text.replace(place, from.size(), to);
}

Expected<ImportedScene> read(const std::string& json, const std::string& buffer) {
    const TestFolder folder;
    return import_scene(folder.write("scene.glb", glb_of(json, buffer)),
                        {.at = 0.5, .motion = Motion::Sequence});
}

void expect_notice(const std::string& from, const std::string& to, const std::string& notice) {
    SCOPED_TRACE(to);
    const SceneFile file = moving_file();
    const auto scene = read(replaced(file.json(), from, to), file.buffer());
    ASSERT_TRUE(scene) << scene.error().what();
    expect_consistent(*scene);
    EXPECT_TRUE(has_notice(*scene, notice));
    EXPECT_NE(named<scene::Transform>(*scene, "cart").matrix, glm::dmat4(1.0)) << "the rest moves";
}

TEST(AnimationMalformed, InvalidChannelsAreSkipped) {
    const std::string wave = R"("target":{"node":3,"path":"rotation"})";
    expect_notice(wave, R"("target":{"node":99,"path":"rotation"})",
                  "animation 'wave': channel 0 is left out: its node is missing");
    expect_notice(wave, R"("target":{"node":-7,"path":"rotation"})", "its node is missing");
    expect_notice(wave, R"("target":{"node":3,"path":"pointer"})", "its target is none of");
    expect_notice(wave, R"("target":{"node":3,"path":"translation"})", "does not have the 3 components");
    expect_notice(wave, R"("target":{"node":3,"path":"weights"})", "its node has no mesh");
    expect_notice(wave, R"("target":{"node":1,"path":"weights"})", "its mesh has no morph targets");
    expect_notice(R"("sampler":0,)" + wave, R"("sampler":5,)" + wave, "its sampler is missing");
    expect_notice(R"("interpolation":"LINEAR"}],"channels":[{"sampler":0,"target":{"node":3)",
                  R"("interpolation":"SMOOTH"}],"channels":[{"sampler":0,"target":{"node":3)",
                  "none of LINEAR, STEP and CUBICSPLINE");
    expect_notice(R"({"name":"hand","translation":[0,1,0]})",
                  R"({"name":"hand","matrix":[1,0,0,0,0,1,0,0,0,0,1,0,0,1,0,1]})", "its node has a matrix");
}

TEST(AnimationMalformed, InvalidSkinsAreIgnored) {
    expect_notice(R"("joints":[2,3])", R"("joints":[2,99])",
                  "skin 0 is ignored: its joint 99 is not in the scene");
    expect_notice(R"("joints":[2,3])", R"("joints":[])", "skin 0 is ignored: it has no joints");
    expect_notice(R"("joints":[2,3])", R"("joints":[2,3,2])", "it has 2 matrices for 3 joints");
    expect_notice(R"("joints":[2,3])", R"("joints":[2])", "a vertex follows joint 1 of a skin that has 1");
    expect_notice(R"("skin":0)", R"("skin":5)", "skin 5 is ignored: it is missing");
    expect_notice(R"("inverseBindMatrices":)", R"("inverseBindMatrices":1,"old":)",
                  "accessor 1 does not have the 16 components");
    expect_notice(R"("JOINTS_0":)", R"("JOINTS_0":0,"_OLD":)", "is used for joints, but holds");
    expect_notice(R"("JOINTS_0")", R"("_NONE")", "the mesh has no joints");
    expect_notice(R"("WEIGHTS_0")", R"("_NONE")", "it lacks WEIGHTS_0");
}

TEST(AnimationMalformed, CyclesOfJointsAreCut) {
    expect_notice(R"({"name":"hand",)", R"({"name":"hand","children":[2],)", "its own ancestor");
    expect_notice(R"("joints":[2,3])", R"("joints":[2,3,3,2,2],"skeleton":9)", "2 matrices for 5 joints");
}

TEST(AnimationMalformed, InvalidKeysAreReported) {
    struct Case {
        std::vector<float> times;
        std::vector<glm::vec4> turns;
        std::string notice;
    };
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const glm::vec4 one{0, 0, 0, 1}, zero{0, 0, 0, 0};
    for (const Case& bad :
         {Case{{0, 0}, {one, one}, "key 1 is not after"}, Case{{1, nan}, {one, one}, "not finite"},
          Case{{0, 1}, {one}, "4 values, but 2 keys need 8"}, Case{{0, 1}, {one, zero}, "not a quaternion"},
          Case{{0, 1}, {one, {nan, 0, 0, 1}}, "not finite"}}) {
        SceneFile file = moving_file();
        const int times = file.accessor(file.view(bad.times), Component::Float, "SCALAR", bad.times.size());
        const int turns = file.accessor(file.view(bad.turns), Component::Float, "VEC4", bad.turns.size());
        file.add("animations", animation("bad", times, turns, 4, "rotation"));
        const auto scene = read(file.json(), file.buffer());
        ASSERT_TRUE(scene) << scene.error().what();
        EXPECT_TRUE(has_notice(*scene, "animation 'bad': channel 0 is left out: "));
        EXPECT_TRUE(has_notice(*scene, bad.notice));
    }
}

TEST(AnimationMalformed, ASplineThatIsNotFiniteNamesNodeAndTime) {
    SceneFile file = moving_file();
    const int times = file.accessor(file.view(std::vector<float>{0, 1e9f}), Component::Float, "SCALAR", 2);
    const int places = file.positions({{0, 0, 0}, {0, 0, 0}, {9e14f, 0, 0}, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}});
    file.add("animations", animation("far", times, places, 4, "translation", "CUBICSPLINE"));
    const TestFolder folder;
    const auto path = folder.write("scene.glb", file.glb());
    const auto scene = import_scene(path, {.at = 5e8});
    ASSERT_FALSE(scene);
    EXPECT_THAT(scene.error().what(), HasSubstr("node 'eye' at 500000000.000000 s"));
    auto sequence = loaded(path, {.at = 0.0, .motion = Motion::Sequence});
    const auto matrix = named<scene::Transform>(sequence, "cart").matrix;
    EXPECT_FALSE(move_to(sequence, 5e8));
    EXPECT_EQ(named<scene::Transform>(sequence, "cart").matrix, matrix) << "as before";
}

// Imports the bytes and moves through the animation; returns whether there was a scene.
bool survives(const std::string& json, const std::string& buffer) {
    auto scene = read(json, buffer);
    if (!scene) {
        EXPECT_NE(scene.error().code(), ErrorCode::Internal);
        return false;
    }
    expect_consistent(*scene);
    if (const auto step = move_to(*scene, 1.25)) expect_consistent(*scene);
    return true;
}

TEST(AnimationFuzz, NumbersOfTheTextReplaced) {
    const SceneFile file = moving_file();
    const std::string json = file.json();
    int read = 0;
    for (std::size_t i = 1; i < json.size(); ++i) {
        const char before = json[i - 1];
        if (!std::isdigit(static_cast<unsigned char>(json[i])) ||
            (before != ':' && before != ',' && before != '['))
            continue;
        std::size_t end = i;
        while (std::isdigit(static_cast<unsigned char>(json[end]))) ++end;
        for (const char* value : {"-1", "0", "1", "3", "65535", "4294967296", "1e30", "-0.5", "null", "[]"}) {
            SCOPED_TRACE(std::string(value) + " in ..." + json.substr(i - std::min<std::size_t>(i, 40), 60));
            read += survives(json.substr(0, i) + value + json.substr(end), file.buffer()) ? 1 : 0;
        }
    }
    EXPECT_GT(read, 500);
}

TEST(AnimationFuzz, FlippedBitsOfTheArrays) {
    const SceneFile file = moving_file();
    CounterRandom random(77);
    int read = 0;
    for (int round = 0; round < 1000; ++round) {
        std::string damaged = file.buffer();
        for (std::uint64_t i = 0; i < 1 + random.below(4); ++i) {
            char& byte = damaged[random.below(damaged.size())];
            byte = static_cast<char>(byte ^ (1 << random.below(8)));
        }
        SCOPED_TRACE(round);
        read += survives(file.json(), damaged) ? 1 : 0;
    }
    EXPECT_GT(read, 500);
}

}  // namespace
}  // namespace tessera::import
