// `tessera render --tev`: the picture while it is rendered.
#include <gtest/gtest.h>

#include <algorithm>
#include <future>

#include "mediator/picture/exr_reader.h"
#include "tests/process/real_cluster.h"
#include "tests/support/fake_tev.h"

namespace tessera::test {
namespace {

struct RenderInTev : testing::Test {
    TemporaryFolder folder;
    FakeTev tev;
    std::string scene = scene_file("room-1.glb");

    // The result of `tessera render` while `tev` shows it, until the command ends.
    nlohmann::json render(const std::string& label, std::vector<std::string> options) {
        options.insert(options.end(), {"--tev", tev.address()});
        auto result =
            std::async(std::launch::async, [&] { return render_embedded(folder, label, scene, options); });
        tev.read();
        return result.get();
    }
};

TEST_F(RenderInTev, ShowsThePictureAndItsLayersWhileItIsRendered) {
    const std::vector<std::string> options{"--size", "96x64", "--spp", "512"};
    const nlohmann::json shown = render("shown", options);
    EXPECT_EQ(tev.name, "shown.exr");
    EXPECT_EQ(tev.created, 1);
    constexpr int Tiles = 2;
    EXPECT_GT(tev.updated, 2 * Tiles) << "only the finished picture was shown";
    for (const char* layer : {"", "variance", "noise", "albedo", "normal", "depth", "samples"}) {
        const picture::Picture file = picture::read_exr(folder / "shown.exr", layer);
        const std::string prefix = *layer == '\0' ? "" : std::string(layer) + ".";
        const auto first = std::ranges::find_if(tev.channels, [&](const std::string& channel) {
            return prefix.empty() ? channel == "R" : channel.starts_with(prefix);
        });
        ASSERT_NE(first, tev.channels.end()) << layer;
        for (std::size_t i = 0; i < file.image.pixel_count(); ++i)
            ASSERT_EQ(tev.planes[*first][i], file.image.pixel(i)[0]) << layer << " " << i;
    }
    EXPECT_EQ(shown["film_hash"], render_embedded(folder, "alone", scene, options)["film_hash"]);
}

TEST_F(RenderInTev, ShowsTheDenoisedPictureAndItsSamples) {
    render("denoised", {"--size", "96x64", "--spp", "8", "--denoise=gauss"});
    const picture::Picture file = picture::read_exr(folder / "denoised.exr");
    for (std::size_t i = 0; i < file.image.pixel_count(); ++i)
        ASSERT_EQ(tev.planes["G"][i], file.image.pixel(i)[1]) << i;
    EXPECT_TRUE(tev.planes.contains("raw.G"));
}

TEST_F(RenderInTev, GoesOnWithoutAViewerThatHasGone) {
    auto result = std::async(std::launch::async, [&] {
        return render_embedded(folder, "alone", scene,
                               {"--size", "96x64", "--spp", "512", "--tev", tev.address()});
    });
    tev.read(1);
    tev.hang_up();
    EXPECT_EQ(result.get()["spp"], 512);
}

TEST_F(RenderInTev, NeedsAViewer) {
    ChildProcess refused(folder.path(), "refused", "tessera",
                         {"render", scene, "-o", folder / "no.png", "--tev", "127.0.0.1:1"});
    EXPECT_EQ(refused.wait(std::chrono::minutes(1)).value_or(-1), 69);
    EXPECT_NE(refused.err().find("cannot reach tev at 127.0.0.1:1"), std::string::npos) << refused.err();
    ChildProcess wrong(folder.path(), "wrong", "tessera",
                       {"render", scene, "-o", folder / "no.png", "--tev", "host:port"});
    EXPECT_EQ(wrong.wait(std::chrono::minutes(1)).value_or(-1), 64);
    EXPECT_NE(wrong.err().find("--tev: 'host:port' is not HOST"), std::string::npos) << wrong.err();
}

}  // namespace
}  // namespace tessera::test
