#include "master/config.h"

#include <gtest/gtest.h>

#include <sstream>
#include <vector>

namespace tessera::master {
namespace {

struct Parsed {
    std::optional<int> exit;
    MasterOptions options;
    std::string err;
};

Parsed parse(const std::vector<const char*>& words) {
    std::vector<const char*> argv{"tessera-master"};
    argv.insert(argv.end(), words.begin(), words.end());
    Parsed parsed;
    std::ostringstream out, err;
    parsed.exit = parse_options(static_cast<int>(argv.size()), argv.data(), parsed.options, out, err);
    parsed.err = err.str();
    return parsed;
}

TEST(MasterOptions, AreParsed) {
    const Parsed parsed = parse({"--insecure", "--listen=tcp://127.0.0.1:1", "--memory", "512",
                                 "--max-crashes", "7", "--verify=2.5"});
    ASSERT_FALSE(parsed.exit) << parsed.err;
    EXPECT_EQ(parsed.options.listen, "tcp://127.0.0.1:1");
    EXPECT_EQ(parsed.options.memory_mib, 512u);
    EXPECT_EQ(parsed.options.max_crashes, 7u);
    EXPECT_EQ(parsed.options.verify_percent, 2.5);
    EXPECT_EQ(parse({"--insecure"}).options.max_crashes, 2u);
}

TEST(MasterOptions, OutOfRangeExit64AndAreNamed) {
    const std::vector<std::vector<const char*>> wrong{
        {"--max-crashes", "1"}, {"--max-crashes", "1001"}, {"--max-crashes", "-1"}, {"--memory", "63"},
        {"--io-threads", "0"},  {"--io-threads", "65"},    {"--verify", "101"},     {"--verify", "nan"},
        {"--heartbeat", "0"},   {"--heartbeat", "61"},     {"--orphan", "-1"},      {"--checkpoint", "0"}};
    for (auto words : wrong) {
        words.push_back("--insecure");
        const Parsed parsed = parse(words);
        EXPECT_EQ(parsed.exit, 64) << words[0] << " " << words[1];
        EXPECT_NE(parsed.err.find(words[0]), std::string::npos) << parsed.err;
    }
}

TEST(MasterOptions, NeedKeysOrSayThatTheyDoWithout) {
    EXPECT_EQ(parse({}).exit, 64);
    EXPECT_NE(parse({}).err.find("--keys"), std::string::npos);
    EXPECT_EQ(parse({"--keys", "a", "--insecure"}).exit, 64);
    EXPECT_FALSE(parse({"--keys", "a"}).exit);
}

}  // namespace
}  // namespace tessera::master
