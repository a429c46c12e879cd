// The commands tessera display check and pattern.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <span>
#include <sstream>

#include "client/tools/display/display_command.h"
#include "mediator/picture/png_reader.h"

namespace tessera::tools {

namespace {

class DisplayCommands : public testing::Test {
  protected:
    void SetUp() override {
        folder_ = std::filesystem::temp_directory_path() / ("tessera-display-" + std::to_string(::getpid()));
        std::filesystem::create_directories(folder_);
        std::ofstream(folder_ / "wall.toml") << "[[wall]]\nname = 'w'\nlower_left = [-1, -1, -2]\n"
                                                "lower_right = [1, -1, -2]\nupper_left = [-1, 1, -2]\n"
                                                "columns = 2\nsize = [160, 120]\noverlap = [20, 0]\n"
                                                "stereo = 'separate'\n";
        std::ofstream(folder_ / "bad.toml") << "[[output]]\nname = 'a'\nsise = [1, 1]\n";
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }

    std::string in_folder(const std::string& name) const { return (folder_ / name).string(); }

    static frame::Image picture_of(const std::string& path) {
        std::ifstream file(path, std::ios::binary);
        const std::string bytes(std::istreambuf_iterator<char>(file), {});
        const auto picture = picture::read_png(std::as_bytes(std::span(bytes)));
        if (!picture) throw picture.error();
        return *picture;
    }

    int run(std::vector<std::string> words) {
        cli::CommandLine line("tessera", "test");
        const Command command = display_command(line);
        words.insert(words.begin(), {"tessera", "display"});
        std::vector<const char*> arguments;
        for (const std::string& word : words) arguments.push_back(word.c_str());
        std::ostringstream ignored;
        if (const auto exit = line.parse(int(arguments.size()), arguments.data(), ignored, ignored))
            return *exit;
        testing::internal::CaptureStdout();
        testing::internal::CaptureStderr();
        const int code = command.run(line.chosen());
        out_ = testing::internal::GetCapturedStdout();
        error_ = testing::internal::GetCapturedStderr();
        return code;
    }

    std::filesystem::path folder_;
    std::string out_, error_;
};

TEST_F(DisplayCommands, CheckPrintsATableAndDrawsPlans) {
    EXPECT_EQ(run({"check", in_folder("wall.toml"), "-o", in_folder("p.png"), "-o", in_folder("p.svg")}), 0);
    EXPECT_NE(out_.find("w-2-1"), std::string::npos) << out_;
    EXPECT_GT(std::filesystem::file_size(folder_ / "p.png"), 1000u);
    EXPECT_GT(std::filesystem::file_size(folder_ / "p.svg"), 1000u);
}

TEST_F(DisplayCommands, ErrorsHaveExitCodeAndPosition) {
    EXPECT_EQ(run({"check", in_folder("bad.toml")}), ExitBadInput);
    EXPECT_NE(error_.find("bad.toml:3:1: output 'a': there is no key 'sise'"), std::string::npos) << error_;
    EXPECT_EQ(run({"check", in_folder("none.toml")}), ExitBadInput);
    EXPECT_EQ(run({"check", in_folder("wall.toml"), "-o", in_folder("p.txt")}), cli::ExitUsage);
    EXPECT_EQ(run({"pattern", in_folder("wall.toml")}), cli::ExitUsage);
    EXPECT_EQ(run({"pattern", in_folder("bad.toml"), "-o", in_folder("x")}), ExitBadInput);
    EXPECT_FALSE(std::filesystem::exists(folder_ / "x"));
    EXPECT_EQ(run({"check", in_folder("wall.toml"), "-o", in_folder("no/p.svg")}), ExitCannotWrite);
}

TEST_F(DisplayCommands, PatternWritesOnePicturePerOutputAndEye) {
    ASSERT_EQ(run({"pattern", in_folder("wall.toml"), "-o", in_folder("out/pattern")}), 0) << error_;
    for (const char* name : {"w-1-1-left.png", "w-1-1-right.png", "w-2-1-left.png", "w-2-1-right.png"}) {
        const auto picture = picture_of(in_folder("out/pattern/" + std::string(name)));
        EXPECT_EQ(picture.width, 160u);
        EXPECT_EQ(picture.height, 120u);
    }
    const auto soft = picture_of(in_folder("out/pattern/w-1-1-left.png"));
    EXPECT_LT(soft.values[3 * 159], 0.5f);  // the border on the soft edge
    EXPECT_EQ(soft.values[3 * 60], 1.0f);
    ASSERT_EQ(run({"pattern", in_folder("wall.toml"), "-o", in_folder("raw"), "--raw"}), 0) << error_;
    EXPECT_EQ(picture_of(in_folder("raw/w-1-1-left.png")).values[3 * 159], 1.0f);
}

}  // namespace

}  // namespace tessera::tools
