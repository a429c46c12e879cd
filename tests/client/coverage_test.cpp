// Counting and reports of tessera coverage.
#include "client/tools/coverage.h"

#include <gtest/gtest.h>

#include <bit>
#include <nlohmann/json.hpp>

#include "client/tools/render_options.h"

namespace tessera::tools {
namespace {

TEST(SampleGrid, IsAsSquareAsPossible) {
    const auto grid = [](std::uint32_t samples) {
        const SampleGrid made = sample_grid(samples);
        return std::pair(made.across, made.down);
    };
    EXPECT_EQ(grid(1), std::pair(1u, 1u));
    EXPECT_EQ(grid(16), std::pair(4u, 4u));
    EXPECT_EQ(grid(8), std::pair(4u, 2u));
    EXPECT_EQ(grid(7), std::pair(7u, 1u));
}

TEST(SampleGrid, EnlargesAViewAndAveragesItsPicture) {
    view::View view;
    view.width = 10;
    view.height = 6;
    view.window = {2, 1, 2, 1};
    spread(view, {4, 2});
    EXPECT_EQ(view.width, 40u);
    EXPECT_EQ(view.height, 12u);
    EXPECT_EQ(view.window, (Rect{8, 2, 8, 2}));
    frame::Image image(8, 2, 1);
    for (std::size_t i = 0; i < 16; ++i) image.values[i] = static_cast<float>(i);
    const frame::Image means = gather(image, {4, 2});
    ASSERT_EQ(means.values.size(), 2u);
    EXPECT_EQ(means.values[0], (0 + 1 + 2 + 3 + 8 + 9 + 10 + 11) / 8.0f);
    EXPECT_EQ(means.values[1], (4 + 5 + 6 + 7 + 12 + 13 + 14 + 15) / 8.0f);
}

// Ten samples: five of 21, two of 20 and of 22, one without a hit. 23 is occluded.
Coverage counted() {
    frame::FilmTile film({0, 0, 5, 2}, {0, 0}, {frame::Channel::Color, frame::Channel::ObjectIndex});
    const auto ids = film.plane(film.channels.first_plane(frame::Channel::ObjectIndex) + 1);
    const std::uint32_t seen[] = {22, 21, 21, 0, 20, 21, 22, 21, 20, 21};
    for (std::size_t i = 0; i < ids.size(); ++i) {
        ids[i] = std::bit_cast<float>(seen[i]);
        film.counts[i] = 1;
    }
    std::vector<scene::Create> scene;
    for (const std::uint64_t id : {20, 21, 22, 23})
        scene.push_back({ObjectId{id}, scene::Geometry{.name = "part " + std::to_string(id)}});
    scene.push_back({ObjectId{24}, scene::Material{}});
    return count_coverage(film, scene);
}

TEST(Coverage, IsSortedWithTiesById) {
    const Coverage coverage = counted();
    EXPECT_EQ(coverage.samples, 10u);
    EXPECT_EQ(coverage.background, 1u);
    EXPECT_EQ(coverage.unseen, 1u);
    ASSERT_EQ(coverage.objects.size(), 3u);
    EXPECT_EQ(coverage.objects[0].id, ObjectId{21});
    EXPECT_EQ(coverage.objects[0].samples, 5u);
    EXPECT_EQ(coverage.objects[1].id, ObjectId{20});
    EXPECT_EQ(coverage.objects[2].id, ObjectId{22});
    EXPECT_EQ(coverage.objects[2].name, "part 22");
}

TEST(Coverage, FractionsAndBackgroundSumToOne) {
    const auto json = nlohmann::json::parse(as_json(counted(), 2));
    double sum = json["background"]["fraction"];
    for (const auto& object : json["objects"]) sum += object["fraction"].get<double>();
    EXPECT_NEAR(sum, 1.0, 1e-12);
    EXPECT_EQ(json["objects"][0]["pixels"], 2.5) << "of two samples each";
    EXPECT_EQ(json["objects"][0]["fraction"], 0.5);
    const std::string text = as_text(counted(), 2);
    EXPECT_LT(text.find("part 21"), text.find("part 20"));
    EXPECT_NE(text.find(" 50.00 %"), std::string::npos) << text;
    EXPECT_NE(text.find("not seen: 1 object"), std::string::npos) << text;
}

TEST(Coverage, OptionsEnlargeTheViewAndNeedNoOutput) {
    RenderOptions options;
    options.coverage = true;
    options.view.scene = "a.glb";
    options.view.size = "64x32";
    const auto plan = parse_options(options);
    ASSERT_TRUE(plan) << plan.error().what();
    EXPECT_EQ(plan->view.view.renderer, view::Renderer::Coverage);
    EXPECT_EQ(plan->view.view.width, 256u);
    EXPECT_EQ(plan->job.stop.spp, 1u);
    EXPECT_FALSE(plan->view.view.channels.contains(frame::Channel::Color));
    options.spp = 4096;
    EXPECT_TRUE(parse_options(options));
    options.view.size = "1920x1080";
    const auto large = parse_options(options);
    ASSERT_FALSE(large);
    EXPECT_NE(std::string(large.error().what()).find("122880x69120"), std::string::npos);
}

}  // namespace
}  // namespace tessera::tools
