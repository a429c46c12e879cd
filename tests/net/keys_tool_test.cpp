#include "client/tools/keys_tool.h"

#include <gtest/gtest.h>

#include <sstream>

#include "mediator/net/keys.h"
#include "tests/net/net_support.h"

namespace tessera::tools {

namespace {

class KeysTool : public testing::Test {
  protected:
    int run(KeysOptions options) {
        options.folder = folder_ / "keys";
        out_.str("");
        testing::internal::CaptureStderr();
        const int code = run_keys(options, out_);
        errors_ = testing::internal::GetCapturedStderr();
        return code;
    }
    int add(const std::string& name) {
        return run({.action = "add", .name = name, .role = "node", .export_file = folder_ / (name + ".key")});
    }

    net::TemporaryFolder folder_;
    std::ostringstream out_;
    std::string errors_;
};

TEST_F(KeysTool, CreatesListsAddsAndRevokes) {
    ASSERT_EQ(run({}), 0) << errors_;
    ASSERT_EQ(add("render-2"), 0) << errors_;
    ASSERT_EQ(run({.action = "list"}), 0);
    const net::KeyDirectory keys(folder_ / "keys");
    for (const net::AllowedKey& key : keys.allowed()) {
        EXPECT_NE(out_.str().find(key.public_key), std::string::npos);
    }
    EXPECT_NE(out_.str().find("render-2"), std::string::npos);
    EXPECT_EQ(out_.str().find(keys.client("node").own.secret_key), std::string::npos) << "a secret was shown";
    ASSERT_EQ(run({.action = "revoke", .name = "render-2"}), 0) << errors_;
    ASSERT_EQ(run({.action = "list"}), 0);
    EXPECT_EQ(out_.str().find("render-2"), std::string::npos);
}

TEST_F(KeysTool, FailuresHaveTheirExitCodesAndMessages) {
    EXPECT_EQ(run({.action = "list"}), ExitBadInput);
    EXPECT_NE(errors_.find("tessera keys"), std::string::npos);
    ASSERT_EQ(run({}), 0);
    EXPECT_EQ(run({}), cli::ExitRefused) << "a master key is never overwritten";
    ASSERT_EQ(add("a"), 0);
    EXPECT_EQ(add("a"), cli::ExitRefused);
    EXPECT_EQ(run({.action = "revoke", .name = "unknown"}), ExitBadInput);
    EXPECT_EQ(run({.action = "revok", .name = "a"}), cli::ExitUsage);
    EXPECT_NE(errors_.find("did you mean 'revoke'"), std::string::npos) << errors_;
}

TEST_F(KeysTool, MissingOrExtraArgumentsAreUsageErrors) {
    ASSERT_EQ(run({}), 0);
    EXPECT_EQ(run({.action = "add"}), cli::ExitUsage);
    EXPECT_EQ(run({.action = "add", .name = "a", .role = "node"}), cli::ExitUsage);
    EXPECT_EQ(run({.action = "add", .name = "a", .export_file = folder_ / "a.key"}), cli::ExitUsage);
    EXPECT_EQ(run({.action = "revoke"}), cli::ExitUsage);
    EXPECT_EQ(run({.action = "list", .name = "a"}), cli::ExitUsage);
    EXPECT_EQ(net::KeyDirectory(folder_ / "keys").allowed().size(), 4u);
}

TEST(KeysCommand, ParsesItsArguments) {
    net::TemporaryFolder folder;
    const std::string keys = folder / "keys", file = folder / "n.key";
    const auto tessera = [](std::vector<const char*> words) {
        words.insert(words.begin(), "tessera");
        cli::CommandLine line("tessera", "test");
        const Command command = keys_command(line);
        std::ostringstream out, err;
        if (const auto exit = line.parse(static_cast<int>(words.size()), words.data(), out, err))
            return *exit;
        return command.run(line.chosen());
    };
    EXPECT_EQ(tessera({"keys", keys.c_str()}), 0);
    EXPECT_EQ(tessera({"keys", keys.c_str(), "add", "n", "--role", "viewer", "--export", file.c_str()}), 0);
    EXPECT_EQ(net::KeyDirectory(keys).allowed().back().role, net::Role::Viewer);
    EXPECT_EQ(tessera({"keys", keys.c_str(), "add", "m", "--role", "boss", "--export", file.c_str()}),
              cli::ExitUsage);
    EXPECT_EQ(tessera({"keys", keys.c_str(), "revoke", "n"}), 0);
    EXPECT_EQ(tessera({"keys"}), cli::ExitUsage);
}

}  // namespace

}  // namespace tessera::tools
