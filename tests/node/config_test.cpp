#include "node/config.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <vector>

#include "mediator/backend/catalog.h"
#include "mediator/base/nearest.h"
#include "mediator/program/command_line.h"

namespace tessera::node {
namespace {

struct Parsed {
    std::optional<int> exit;
    NodeOptions options;
    std::string out, err;
};

Parsed parse(const std::vector<const char*>& words) {
    std::vector<const char*> argv{"tessera-node"};
    argv.insert(argv.end(), words.begin(), words.end());
    Parsed parsed;
    std::ostringstream out, err;
    parsed.exit = parse_options(static_cast<int>(argv.size()), argv.data(), parsed.options, out, err);
    parsed.out = out.str();
    parsed.err = err.str();
    return parsed;
}

bool mentions(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

TEST(NodeOptions, ParsesItsOptions) {
    const Parsed parsed = parse({"--master", "tcp://a:1", "--insecure", "--backend", "null", "--threads=3",
                                 "--simulate-cost", "20us", "--name", "left"});
    ASSERT_FALSE(parsed.exit) << parsed.err;
    EXPECT_EQ(parsed.options.master, "tcp://a:1");
    EXPECT_EQ(parsed.options.threads, 3u);
    EXPECT_EQ(parsed.options.backend, "null");
    EXPECT_EQ(parsed.options.simulated_cost, std::chrono::microseconds(20));
    EXPECT_EQ(parsed.options.name, "left");
    EXPECT_FALSE(parsed.options.host.empty());
}

TEST(NodeOptions, AnUnknownOptionExits64WithTheClosestOne) {
    const Parsed parsed = parse({"--master", "tcp://a:1", "--insecure", "--thraeds", "3"});
    EXPECT_EQ(parsed.exit, 64);
    EXPECT_TRUE(mentions(parsed.err, "'--thraeds'") && mentions(parsed.err, "'--threads'")) << parsed.err;
    const Parsed equals = parse({"--mastr=tcp://a:1"});
    EXPECT_EQ(equals.exit, 64);
    EXPECT_TRUE(mentions(equals.err, "'--master'")) << equals.err;
}

TEST(NodeOptions, AWrongChoiceOrNumberExits64) {
    const Parsed choice = parse({"--master", "tcp://a:1", "--insecure", "--backend", "nul"});
    EXPECT_EQ(choice.exit, 64);
    EXPECT_TRUE(mentions(choice.err, "did you mean 'null'")) << choice.err;
    EXPECT_EQ(parse({"--master", "tcp://a:1", "--insecure", "--threads", "many"}).exit, 64);
    EXPECT_EQ(parse({"--master", "tcp://a:1", "--insecure", "--threads", "-1"}).exit, 64);
    EXPECT_EQ(parse({"--master", "tcp://a:1", "--insecure", "--threads", "4097"}).exit, 64);
    EXPECT_EQ(parse({"--master", "tcp://a:1", "--insecure", "--simulate-cost", "20"}).exit, 64);
    EXPECT_EQ(parse({"--master", "tcp://a:1", "--insecure", "stray"}).exit, 64);
}

TEST(NodeOptions, ADeviceIsOfferedOnlyWhereABackEndHasAChoice) {
    const Parsed null_device =
        parse({"--master", "tcp://a:1", "--insecure", "--backend", "null", "--device", "0"});
    EXPECT_EQ(null_device.exit, 64);
    EXPECT_TRUE(mentions(null_device.err, "--device")) << null_device.err;
    EXPECT_EQ(mentions(parse({"--help"}).out, "--device"), backend::has_device_choice());
    for (const backend::BackendEntry& entry : backend::catalog()) {
        EXPECT_TRUE(backend::check_device(entry, ""));
        EXPECT_EQ(backend::check_device(entry, "0").has_value(), entry.chooses_device);
        if (!entry.chooses_device) continue;
        const Parsed chosen = parse(
            {"--master", "tcp://a:1", "--insecure", "--backend", entry.name.c_str(), "--device", "llvmpipe"});
        ASSERT_FALSE(chosen.exit) << chosen.err;
        EXPECT_EQ(chosen.options.device, "llvmpipe");
    }
}

TEST(NodeOptions, MissingOrContradictoryOptionsExit64) {
    EXPECT_EQ(parse({"--insecure"}).exit, 64);
    EXPECT_EQ(parse({"--master", "tcp://a:1"}).exit, 64);
    EXPECT_EQ(parse({"--master", "a:1", "--insecure"}).exit, 64);
    EXPECT_EQ(parse({"--master", "tcp://a:1", "--insecure", "--keys", "k"}).exit, 64);
}

TEST(NodeOptions, HelpAndVersionExit0) {
    const Parsed help = parse({"--help"});
    EXPECT_EQ(help.exit, 0);
    EXPECT_TRUE(mentions(help.out, "Examples:") && mentions(help.out, "--simulate-cost"));
    const Parsed version = parse({"--version"});
    EXPECT_EQ(version.exit, 0);
    EXPECT_TRUE(mentions(version.out, cli::version()));
}

struct ConfigFileTest : testing::Test {
    ~ConfigFileTest() override { std::filesystem::remove(path); }
    Parsed with(const std::string& content, std::vector<const char*> words = {}) {
        std::ofstream(path) << content;
        words.insert(words.begin(), {"--config", path.c_str()});
        return parse(words);
    }
    const std::string path =
        (std::filesystem::temp_directory_path() / ("tessera-node-" + std::to_string(::getpid()) + ".toml"))
            .string();
};

TEST_F(ConfigFileTest, HasTheSameOptionsAndIsOverriddenByTheCommandLine) {
    const std::string content = "master = \"tcp://a:1\"\ninsecure = true\nthreads = 5\nname = \"left\"\n";
    const Parsed plain = with(content);
    ASSERT_FALSE(plain.exit) << plain.err;
    EXPECT_EQ(plain.options.threads, 5u);
    EXPECT_EQ(plain.options.name, "left");
    const Parsed typed = with(content, {"--threads", "2"});
    ASSERT_FALSE(typed.exit) << typed.err;
    EXPECT_EQ(typed.options.threads, 2u);
}

TEST_F(ConfigFileTest, ItsErrorsExit64WithTheirLine) {
    const Parsed unknown = with("mastr = \"tcp://a:1\"\ninsecure = true\n");
    EXPECT_EQ(unknown.exit, 64);
    EXPECT_TRUE(mentions(unknown.err, "'--master'")) << unknown.err;
    const Parsed broken = with("master = \n");
    EXPECT_EQ(broken.exit, 64);
    EXPECT_TRUE(mentions(broken.err, path) && mentions(broken.err, "line 1")) << broken.err;
    EXPECT_EQ(with("threads = 1979-05-27\n").exit, 64);
    EXPECT_EQ(parse({"--config", "/nowhere/at-all.toml"}).exit, 64);
}

TEST(Durations, AreWrittenWithTheirUnit) {
    EXPECT_EQ(parse_duration("1.5ms").value(), std::chrono::microseconds(1500));
    EXPECT_EQ(parse_duration("0s").value(), Duration(0));
    for (const char* wrong : {"", "5", "us", "-1s", "5 s", "1e99s", "nans", "infs"}) {
        EXPECT_FALSE(parse_duration(wrong)) << wrong;
    }
}

TEST(Nearest, IsCloseOrNothing) {
    EXPECT_EQ(nearest("rende", {"render", "probe"}), "render");
    EXPECT_EQ(nearest("xyzzy", {"render", "probe"}), std::nullopt);
    EXPECT_EQ(nearest("", {}), std::nullopt);
}

}  // namespace
}  // namespace tessera::node
