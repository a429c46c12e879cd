// `--denoise oidn` with and without Open Image Denoise, of which a stand-in is found by LD_LIBRARY_PATH.
#include <gtest/gtest.h>

#include <algorithm>
#include <optional>

#include "master/filter/oidn/library.h"
#include "mediator/picture/exr_reader.h"
#include "tests/process/real_cluster.h"
#include "tests/support/environment.h"

namespace tessera::test {
namespace {

using nlohmann::json;

constexpr const char* Sentence = "filter 'oidn' needs Open Image Denoise on the machine that filters, and ";

struct Ended {
    int code = -1;
    std::string out, err;
};

class OidnCommand : public testing::Test {
  protected:
    Ended run(std::vector<std::string> words) {
        ChildProcess process(folder_.path(), "command", "tessera", words);
        const int code = process.wait(std::chrono::minutes(2)).value_or(-1);
        return {code, process.out(), process.err()};
    }
    Ended render(const std::string& picture, std::vector<std::string> more) {
        std::vector<std::string> words{"render",    scene_file("room-1.glb"),
                                       "-o",        folder_ / picture,
                                       "--size",    "48x27",
                                       "--spp",     "2",
                                       "--backend", "null",
                                       "--threads", "1"};
        words.insert(words.end(), more.begin(), more.end());
        return run(words);
    }
    bool is_there(const std::string& name) const { return std::filesystem::exists(folder_ / name); }

    TemporaryFolder folder_;
};

// One line on standard error that names what is missing and what to do.
void expect_unavailable(const Ended& ended, const std::string& what) {
    EXPECT_EQ(ended.code, 69) << ended.err;
    EXPECT_NE(ended.err.find(Sentence + what), std::string::npos) << ended.err;
    EXPECT_NE(ended.err.find("or choose another filter"), std::string::npos) << ended.err;
    EXPECT_EQ(std::ranges::count(ended.err, '\n'), 1) << ended.err;
}

TEST_F(OidnCommand, IsUnavailableWithoutTheLibrary) {
    if (filter::oidn::installed_library()) GTEST_SKIP() << "Open Image Denoise is installed on this machine";
    expect_unavailable(render("a.png", {"--denoise=oidn"}), "it is not installed there");
    expect_unavailable(render("a.png", {"--filter", "oidn:blend=off"}), "it is not installed there");
    expect_unavailable(run({"filter", folder_ / "none.exr", "-o", folder_ / "a.exr", "--filter", "oidn"}),
                       "it is not installed");
    EXPECT_FALSE(is_there("a.png"));
    const Ended listed = run({"filters"});
    EXPECT_EQ(listed.code, 0) << listed.err;
    EXPECT_NE(listed.out.find(std::string("unavailable: ") + Sentence), std::string::npos) << listed.out;
}

TEST_F(OidnCommand, IsUnavailableWithAnIncompleteLibrary) {
    const EnvironmentVariable libraries("LD_LIBRARY_PATH",
                                        library_path(open_image_denoise("oidn-incomplete")));
    expect_unavailable(
        render("a.png", {"--denoise=oidn"}),
        "libOpenImageDenoise.so.2 cannot be used there: it lacks the function oidnExecuteFilter");
    EXPECT_FALSE(is_there("a.png"));
}

TEST_F(OidnCommand, ListsWhetherItIsAvailable) {
    for (const bool available : {true, false}) {
        const EnvironmentVariable libraries(
            "LD_LIBRARY_PATH", library_path(open_image_denoise(available ? "oidn" : "oidn-incomplete")));
        const Ended listed = run({"filters", "--json"});
        ASSERT_EQ(listed.code, 0) << listed.err;
        for (const json& filter : json::parse(listed.out)) {
            const bool is_oidn = filter["name"] == "oidn";
            EXPECT_EQ(filter["available"], !is_oidn || available) << filter.dump(1);
            EXPECT_EQ(filter["why_unavailable"].get<std::string>().empty(), !is_oidn || available);
            EXPECT_EQ(filter["reproducible"], !is_oidn);
        }
    }
}

TEST_F(OidnCommand, RendersAndFiltersWithTheLibrary) {
    const EnvironmentVariable libraries("LD_LIBRARY_PATH", library_path(open_image_denoise()));
    const Ended rendered = render("film.exr", {"--denoise=oidn:blend=off", "--save-statistics"});
    ASSERT_EQ(rendered.code, 0) << rendered.err;
    const Ended none = run({"filter", folder_ / "film.exr", "-o", folder_ / "none.exr", "--filter", "none"});
    ASSERT_EQ(none.code, 0) << none.err;
    EXPECT_NE(picture::read_exr(folder_ / "film.exr").image.values,
              picture::read_exr(folder_ / "none.exr").image.values);
    const Ended again =
        run({"filter", folder_ / "film.exr", "-o", folder_ / "again.exr", "--filter", "oidn:blend=off"});
    ASSERT_EQ(again.code, 0) << again.err;
    EXPECT_EQ(picture::read_exr(folder_ / "again.exr").image.values,
              picture::read_exr(folder_ / "film.exr").image.values);
}

TEST_F(OidnCommand, IsNotForReproducibleFrames) {
    for (const char* stand_in : {"oidn", "oidn-incomplete"}) {
        const EnvironmentVariable libraries("LD_LIBRARY_PATH", library_path(open_image_denoise(stand_in)));
        const Ended ended = render("a.png", {"--denoise=oidn", "--reproducible"});
        EXPECT_EQ(ended.code, 64) << ended.err;
        EXPECT_NE(ended.err.find("--reproducible: filter 'oidn' does not give the same bits"),
                  std::string::npos)
            << ended.err;
        EXPECT_EQ(render("b.png", {"--denoise=gauss", "--reproducible"}).code, 0);
    }
}

TEST_F(OidnCommand, AFailureIsAnError) {
    const EnvironmentVariable libraries("LD_LIBRARY_PATH", library_path(open_image_denoise()));
    ASSERT_EQ(render("film.exr", {"--save-statistics"}).code, 0);
    const EnvironmentVariable fails("TESSERA_OIDN_FAILS", "execute");
    const std::string reason = "Open Image Denoise cannot filter the picture: the network is lost";
    const Ended rendered = render("a.png", {"--denoise=oidn"});
    EXPECT_EQ(rendered.code, 70) << rendered.err;
    EXPECT_NE(rendered.err.find(reason), std::string::npos) << rendered.err;
    const Ended filtered = run({"filter", folder_ / "film.exr", "-o", folder_ / "a.exr", "--filter", "oidn"});
    EXPECT_EQ(filtered.code, 69) << filtered.err;
    EXPECT_NE(filtered.err.find(reason), std::string::npos) << filtered.err;
    EXPECT_FALSE(is_there("a.png") || is_there("a.exr"));
}

// The master filters: what its machine lacks counts, not what the client's has.
TEST_F(OidnCommand, AMasterWithoutTheLibraryRefusesTheView) {
    std::optional<RealCluster> cluster;
    {
        const EnvironmentVariable libraries("LD_LIBRARY_PATH",
                                            library_path(open_image_denoise("oidn-incomplete")));
        cluster.emplace();
    }
    const ChildProcess node = cluster->start_node("a", {"--backend", "null"});
    const EnvironmentVariable libraries("LD_LIBRARY_PATH", library_path(open_image_denoise()));
    const std::vector<std::string> options{"--size", "48x27", "--spp", "2", "--wait-nodes", "1:60"};
    std::vector<std::string> denoised = options;
    denoised.push_back("--denoise=oidn");
    ChildProcess refused = cluster->start_render("refused", scene_file("room-1.glb"), denoised);
    const int code = refused.wait(std::chrono::minutes(2)).value_or(-1);
    expect_unavailable({code, refused.out(), refused.err()},
                       "libOpenImageDenoise.so.2 cannot be used there: it lacks the function");
    expect_unavailable(
        run({"set-filter", "oidn", "--master", cluster->endpoint(), "--keys", cluster->keys()}),
        "libOpenImageDenoise.so.2 cannot be used there");
    EXPECT_TRUE(cluster->master().running());
    const json other = cluster->render("other", scene_file("room-1.glb"), options);
    EXPECT_TRUE(other.contains("film_hash")) << other.dump(1);
}

}  // namespace
}  // namespace tessera::test
