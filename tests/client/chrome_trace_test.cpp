#include "client/tools/chrome_trace.h"

#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>
#include <set>

namespace tessera::tools {

namespace {

using Json = nlohmann::json;

std::vector<session::EditTrace> two_edits() {
    session::EditTrace first{
        .transaction = 7,
        .name = "anna",
        .edit_bytes = 50,
        .submitted = 1'000'000,
        .bound = 2'000,
        .received = 1'500'000,
        .published = 2'000'000,
        .nodes = {{.name = "n1", .received = 2'100'000, .built = 2'600'000, .bound = 500},
                  {.name = "n2", .received = 2'200'000, .built = 0}},
        .merged = 9'000'000,
        .version = {1, 4}};
    session::EditTrace second = first;
    second.name = "a \xff name \"of\" any bytes";
    second.submitted = 0;
    second.received = 1'600'000;
    second.published = 1'599'000;  // a clock's error
    second.nodes.clear();
    second.merged = 0;
    return {first, second};
}

struct Slice {
    std::string name;
    double begin, end;
};

std::map<std::string, std::vector<Slice>> slices_by_row(const Json& file) {
    std::map<int, std::string> names;
    std::map<int, std::vector<Slice>> slices;
    std::map<std::string, double> begins;
    for (const Json& event : file.at("traceEvents")) {
        const int row = event.at("pid");
        const std::string phase = event.at("ph");
        if (phase == "M") {
            if (event.at("name") == "process_name") names[row] = event.at("args").at("name");
            continue;
        }
        const std::string key =
            event.at("name").get<std::string>() + event.at("id").dump() + std::to_string(row);
        if (phase == "b") {
            EXPECT_TRUE(begins.emplace(key, event.at("ts")).second);
        } else {
            EXPECT_EQ(phase, "e");
            slices[row].push_back({event.at("name"), begins.at(key), event.at("ts")});
            begins.erase(key);
        }
    }
    EXPECT_TRUE(begins.empty()) << "a slice without end";
    std::map<std::string, std::vector<Slice>> by_name;
    for (const auto& [row, name] : names) by_name[name] = slices[row];
    EXPECT_EQ(by_name.size(), names.size());
    return by_name;
}

TEST(ChromeTrace, HasARowForEachClientTheMasterAndEachNode) {
    const auto rows = slices_by_row(Json::parse(chrome_trace(two_edits())));
    ASSERT_EQ(rows.size(), 5u);
    EXPECT_TRUE(rows.contains("master"));
    EXPECT_TRUE(rows.contains("node n1"));
    const auto& anna = rows.at("client anna");
    ASSERT_EQ(anna.size(), 1u);
    EXPECT_EQ(anna[0].name, "transaction 7 to master");
    EXPECT_DOUBLE_EQ(anna[0].begin, 0.0);  // times count from the first
    EXPECT_DOUBLE_EQ(anna[0].end, 500.0);  // us
    const auto& node = rows.at("node n1");
    ASSERT_EQ(node.size(), 2u);
    EXPECT_DOUBLE_EQ(node[1].begin, 1100.0);
    EXPECT_DOUBLE_EQ(node[1].end, 1600.0);
    EXPECT_EQ(rows.at("node n2").size(), 1u);  // not built yet
    EXPECT_EQ(rows.at("master").size(), 3u);
}

TEST(ChromeTrace, NoSliceEndsBeforeItBegins) {
    for (const auto& [row, slices] : slices_by_row(Json::parse(chrome_trace(two_edits())))) {
        for (const Slice& slice : slices) EXPECT_GE(slice.end, slice.begin) << row << ": " << slice.name;
    }
}

TEST(ChromeTrace, EmptyTraceIsValid) {
    EXPECT_EQ(slices_by_row(Json::parse(chrome_trace({}))).size(), 1u);
}

}  // namespace

}  // namespace tessera::tools
