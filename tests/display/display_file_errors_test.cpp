#include <gtest/gtest.h>

#include <random>

#include "client/display_file/display_file.h"

namespace tessera::display_file {

namespace {

std::string refusal(std::string_view text) {
    scene::BlobStore blobs;
    try {
        parse_display(text, "wall.toml", blobs);
    } catch (const Error& error) {
        return error.what();
    }
    return "taken";
}

constexpr std::string_view WallText =
    "[[wall]]\nname = 'w'\nlower_left = [-1, -1, -2]\nlower_right = [1, -1, -2]\nupper_left = [-1, 1, -2]\n";

struct Wrong {
    std::string text;
    const char* place;
    const char* says;
};

TEST(DisplayFileErrors, NamePositionCauseAndRemedy) {
    const std::string wall(WallText), output("[[output]]\nname = 'a'\n");
    const std::vector<Wrong> all{
        {"", "wall.toml:", "no outputs"},
        {"[[output]\n", "wall.toml:1:", "not valid TOML"},
        {output + "sise = [1, 2]\n", "wall.toml:3:1: output 'a': ", "did you mean 'size'?"},
        {"[displai]\n" + output, "wall.toml:1:", "did you mean 'display'?"},
        {output + "size = [0, 2]\n", "wall.toml:3:", "from 1 to 16384"},
        {output + "size = [1.5, 2]\n", "wall.toml:3:", "whole"},
        {output + "size = 3\n", "wall.toml:3:", "a list"},
        {output + "size = [nan, 2]\n", "wall.toml:3:", "nan"},
        {output + "size = ['a', 2]\n", "wall.toml:3:", "instead of a number"},
        {output + output, "wall.toml:4:", "names overlap"},
        {"[[output]]\n", "wall.toml:1:", "needs 'name'"},
        {"[[output]]\nname = '../x'\n", "wall.toml:2:", "letters"},
        {output + "priority = 3\n", "wall.toml:3:", "1, 2, 4 or 8"},
        {output + "turn = 45\n", "wall.toml:3:", "90"},
        {output + "stereo = 'anaglif'\n", "wall.toml:3:", "did you mean 'anaglyph'?"},
        {output + "lower_left = [0, 0, -1]\n", "wall.toml:1:", "needs 'lower_right'"},
        {output + "screen = 'x'\n", "wall.toml:3:", "no [[screen]] 'x'"},
        {output + "fov = 40\ncylinder = { radius = 1 }\n", "wall.toml:1:", "several kinds"},
        {output + "color = { gamma = 2, curve = [0, 1] }\n", "wall.toml:3:", "both"},
        {output + "color = { gain = inf }\n", "wall.toml:3:", "from 0 to 100"},
        {output + "stereo = 'rows'\ncylinder = { radius = 2, from = -10, to = 10, bottom = -1, top = 1 }\n",
         "wall.toml:3:", "interlaced rows"},
        {output + "turn = 90\ncylinder = { radius = 2, from = -10, to = 10, bottom = -1, top = 1 }\n",
         "wall.toml:3:", "leave 'turn' out"},
        {output + "cylinder = { radius = 2, from = -90, to = 90, bottom = -1, top = 1 }\n",
         "wall.toml:1:", "split"},
        {output +
             "size = [16384, 16384]\ncylinder = { radius = 2, from = -9, to = 9, bottom = -1, top = 1 }\n",
         "wall.toml:3:", "split"},
        {output + "size = [16384, 16384]\n", "wall.toml:1:1: output 'a': ", "200 MiB"},
        {"[display]\nwhite = 1e-9\n" + output, "wall.toml:1:", "white"},
        {output + "stereo = 'side-by-side'\nsize = [101, 100]\n", "wall.toml:4:", "even"},
        {wall + "[head]\nposition = [0, 0, -2]\n", "wall.toml:1:1: output 'w-1-1': ", "in front"},
        {wall + "[head]\nposition = [0, 0, -5]\n", "wall.toml:1:", "in front"},
        {wall + "stereo = 'separate'\n[head]\nposition = [0, 0, -1.99]\nlook = [1, 0, 0]\n",
         "wall.toml:1:", "in front"},
        {wall + "columns = 9\nrows = 9\n", "wall.toml:6:", "81 outputs"},
        {wall + "bezel = [0.01, 0]\ncolumns = 2\noverlap = [10, 0]\n",
         "wall.toml:1:", "give only one of them"},
        {"[[wall]]\nname = 'w'\nlower_left = [0, 0, -2]\nlower_right = [1, 0, -2]\nupper_left = [1, 1, -2]\n",
         "wall.toml:3:", "cross"},
        {"[[wall]]\nname = 'w'\nlower_left = [0, 0, -2]\nlower_right = [1, 0, -2]\nupper_left = [0, 0, -2]\n",
         "wall.toml:3:", "no area"},
        {output + "[head]\neye_separation = -1\n", "wall.toml:4:", "from 0 to"},
        {output + "[head]\nlook = [0, 0, 0]\n", "wall.toml:4:", "no length"},
        {output + "[[layer]]\nname = 'l'\nlayers = []\n", "wall.toml:5:", "empty"},
        {output + "[[layer]]\nname = 'l'\nrenderer = 'rastr'\n", "wall.toml:5:", "did you mean 'raster'?"},
        {output + "[[adjust]]\noutput = 'b'\n", "wall.toml:4:", "no such output"},
        {output + "projector = { position = [0, 0, 0], look_at = [0, 0, 1], throw = 1 }\n",
         "wall.toml:1:", "towards the screen"},
        {output + "projector = { position = [0, 0, 0], look_at = [0, 0, -1] }\n", "wall.toml:3:", "throw"},
        {"[display]\nrate = 0\n" + output, "wall.toml:2:", "0.1"},
        {"[display]\ncoarsest = 3\n" + output, "wall.toml:2:", "1, 2, 4 or 8"},
        {"[display]\nname = 1979-05-27\n" + output, "wall.toml:2:", "a date"},
    };
    for (const Wrong& wrong : all) {
        const std::string said = refusal(wrong.text);
        EXPECT_TRUE(said.starts_with(wrong.place)) << wrong.text << "\n" << said;
        EXPECT_NE(said.find(wrong.says), std::string::npos) << wrong.text << "\n" << said;
    }
}

const std::string Whole = std::string(WallText) + R"(columns = 2
overlap = [100, 0]
color = { gain = [1, 0.9, 0.8], curve = [0, 0.5, 1] }
[head]
position = [0, 0.1, 0.2]
[[screen]]
name = "c"
cylinder = { radius = 3, from = -30, to = 30, bottom = -1, top = 1 }
[[output]]
name = "p"
size = [64, 40]
screen = "c"
projector = { position = [0, 1, 0.5], look_at = [0, 0, -3], throw = 1.5 }
)";

// Accepted or rejected, without a crash.
void expect_an_answer(const std::string& text) {
    scene::BlobStore blobs;
    try {
        parse_display(text, "wall.toml", blobs);
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::InvalidInput);
    }
}

TEST(DisplayFileErrors, TruncatedFilesDoNotCrash) {
    ASSERT_EQ(refusal(Whole), "taken");
    for (std::size_t length = 0; length < Whole.size(); ++length) expect_an_answer(Whole.substr(0, length));
}

TEST(DisplayFileErrors, RandomBytesDoNotCrash) {
    std::mt19937 random(1);
    for (int trial = 0; trial < 3000; ++trial) {
        std::string text(random() % 200, ' ');
        for (char& c : text) c = char(random());
        expect_an_answer(text);
    }
}

TEST(DisplayFileErrors, ChangedBytesDoNotCrash) {
    std::mt19937 random(2);
    constexpr std::string_view Likely = "[]{}=\"'.,-+e0123456789nai\n\t #";
    for (int trial = 0; trial < 3000; ++trial) {
        std::string text = Whole;
        for (int change = 0; change < 3; ++change)
            text[random() % text.size()] = Likely[random() % Likely.size()];
        expect_an_answer(text);
    }
}

TEST(DisplayFileErrors, MalformedNumbersDoNotCrash) {
    for (const char* number :
         {"nan", "-nan", "inf", "-inf", "1e308", "-1e308", "1e-308", "0", "-0.0", "9223372036854775807",
          "-9223372036854775808", "1e400", "0x7fffffffffffffff"}) {
        for (std::size_t at = 0; at < Whole.size(); ++at) {
            if (!std::isdigit(static_cast<unsigned char>(Whole[at]))) continue;
            std::string text = Whole;
            text.replace(at, 1, number);
            expect_an_answer(text);
        }
    }
}

TEST(DisplayFileErrors, DeepNestingDoesNotCrash) {
    expect_an_answer("x = " + std::string(100, '[') + std::string(100, ']'));
    expect_an_answer("x = " + std::string(100000, '['));
}

}  // namespace

}  // namespace tessera::display_file
