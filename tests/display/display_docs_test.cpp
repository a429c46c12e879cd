// The examples in docs/displays.md are valid.
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

#include "client/display_file/display_file.h"
#include "tests/support/folders.h"

namespace tessera::display_file {

namespace {

std::vector<std::string> examples() {
    std::ifstream file(test::source_folder() / "docs/displays.md");
    const std::string text(std::istreambuf_iterator<char>(file), {});
    std::vector<std::string> found;
    const std::string begin = "```toml\n", end = "```\n";
    for (std::size_t at = text.find(begin); at != std::string::npos; at = text.find(begin, at)) {
        at += begin.size();
        found.push_back(text.substr(at, text.find(end, at) - at));
    }
    return found;
}

TEST(DisplayDocs, EveryExampleIsValid) {
    const std::vector<std::string> all = examples();
    ASSERT_GE(all.size(), 6u);
    std::string wall;
    for (std::string example : all) {
        if (example.find("[[wall]]") != std::string::npos) wall = example;
        if (example.find("[[adjust]]") != std::string::npos) example = wall + example;
        if (example.find("[[output]]") == std::string::npos && example.find("[[wall]]") == std::string::npos)
            example += "[[output]]\nname = 'a'\n";
        scene::BlobStore blobs;
        EXPECT_NO_THROW(parse_display(example, "example.toml", blobs)) << example;
    }
}

}  // namespace

}  // namespace tessera::display_file
