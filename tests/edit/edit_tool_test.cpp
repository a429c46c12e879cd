#include <fstream>
#include <iostream>
#include <sstream>

#include "client/tools/edit.h"
#include "tests/edit/fake_target.h"
#include "tests/import/scene_file.h"

namespace tessera::tools {
namespace {

using testing::HasSubstr;

// Runs the command on a local scene.
class EditTool : public testing::Test {
  protected:
    int run(std::vector<std::string> arguments, const std::string& piped = {}) {
        cli::CommandLine program("tessera", "test");
        const Command command = edit_command(program, [&](const SceneAddress& address) {
            address_ = address;
            return std::make_unique<edit::FakeTarget>();
        });
        arguments.insert(arguments.begin(), {"tessera", "edit", "--master", "tcp://m:1"});
        std::vector<const char*> words;
        for (const std::string& argument : arguments) words.push_back(argument.c_str());
        std::ostringstream out, error;
        std::istringstream in(piped);
        auto* const real_in = std::cin.rdbuf(in.rdbuf());
        auto* const real_out = std::cout.rdbuf(out.rdbuf());
        auto* const real_error = std::cerr.rdbuf(error.rdbuf());
        int code = program.parse(static_cast<int>(words.size()), words.data(), out, error).value_or(-1);
        if (code < 0) code = command.run("edit");
        std::cin.rdbuf(real_in);
        std::cout.rdbuf(real_out);
        std::cerr.rdbuf(real_error);
        out_ = out.str();
        error_ = error.str();
        return code;
    }
    SceneAddress address_;
    std::string out_, error_;
    import::TestFolder folder_;
};

TEST_F(EditTool, RunsAScriptFromAFile) {
    const std::string file =
        folder_.write("tour.txt", "set lights/bulb.intensity 5\nshow lights/bulb\n").string();
    EXPECT_EQ(run({file, "--user", "anna", "--name", "wall", "--scene", "room"}), 0) << error_;
    EXPECT_THAT(out_, HasSubstr("5 5 5"));
    EXPECT_EQ(address_.master, "tcp://m:1");
    EXPECT_EQ(address_.user, "anna");
    EXPECT_EQ(address_.name, "wall");
    EXPECT_EQ(address_.title, "room");
}

TEST_F(EditTool, RunsAScriptFromAPipe) {
    EXPECT_EQ(run({"-"}, "list lights"), 0) << error_;
    EXPECT_EQ(out_, "lights/bulb\nlights/spot\nlights/sun\n");
}

TEST_F(EditTool, RunsCommandsAsOneScript) {
    EXPECT_EQ(run({"-c", "create light a", "-c", "find a"}), 0) << error_;
    EXPECT_EQ(out_, "lights/a\n");
    EXPECT_EQ(run({"-c", "create light a", "-c", "find"}), ExitBadScript);
    EXPECT_THAT(error_, HasSubstr("tessera edit: -c:2:5: 'find' needs more"));
}

TEST_F(EditTool, MistakesNameFileLineAndColumn) {
    const std::string file = folder_.write("tour.txt", "list\n  shw root\n").string();
    EXPECT_EQ(run({file}), ExitBadScript);
    EXPECT_THAT(error_, HasSubstr(file + ":2:3: there is no command 'shw'"));
    EXPECT_EQ(out_, "");
}

TEST_F(EditTool, ReportsUnreadableScripts) {
    EXPECT_EQ(run({(folder_.path() / "none.txt").string()}), ExitBadInput);
    EXPECT_EQ(run({folder_.path().string()}), ExitBadInput);
    EXPECT_EQ(run({"a.txt", "-c", "list"}), cli::ExitUsage);
}

}  // namespace
}  // namespace tessera::tools
