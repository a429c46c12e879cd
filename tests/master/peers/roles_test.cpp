#include "master/peers/roles.h"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <map>
#include <set>

#include "tests/support/folders.h"

namespace tessera::master {
namespace {

using net::Role;
using Names = std::set<std::string, std::less<>>;

// What a role may send beyond the roles before it, written apart from the table of messages.
const Names ByAll{"heartbeat", "goodbye", "bulk_hello", "blob_request"};
const Names ByClients{"status_request", "join_scene", "read_scene",  "set_presence", "read_members",
                      "frame_taken",    "pick",       "join_output", "output_ready", "request_view",
                      "end_view",       "read_jobs",  "fetch_job"};
const Names ByEditors{"submit_edit",   "submit_edit_by_blob", "close_scene", "lock_objects",
                      "read_history",  "read_writers",        "read_trace",  "open_display",
                      "close_display", "adjust_display",      "move_head",   "set_view_filter",
                      "cancel_job",    "blob_chunk",          "blob_absent"};
const Names ByNodes{"version_report", "resync", "unit_released", "notice", "scene_refused", "film_part"};
const Names ByOperators{"manage_node"};

bool expected(Role role, std::string_view name) {
    const bool editor = role == Role::Editor || role == Role::Operator;
    const bool client = editor || role == Role::Viewer;
    const bool node = role == Role::Node || role == Role::Operator;
    return (ByAll.contains(name) && (client || node)) || (ByClients.contains(name) && client) ||
           (ByEditors.contains(name) && editor) || (ByNodes.contains(name) && node) ||
           (ByOperators.contains(name) && role == Role::Operator);
}

// Every pair of role and message.
TEST(Roles, AreThoseOfTheTable) {
    constexpr Role All[] = {Role::None, Role::Viewer, Role::Editor, Role::Node, Role::Operator};
    int pairs = 0;
    const auto walk = [&](const auto& message, std::string_view name) {
        if (name == "hello") return;  // its own test
        for (const Role role : All) {
            EXPECT_EQ(allowed(role, message), expected(role, name)) << net::name(role) << " " << name;
            ++pairs;
        }
    };
    wire::table::Control::for_each(
        [&](const wire::ControlMessage& message, std::string_view name) { walk(message, name); });
    wire::table::Bulk::for_each(
        [&](const wire::BulkMessage& message, std::string_view name) { walk(message, name); });
    EXPECT_GT(pairs, 300);
}

TEST(Roles, ClientsAndNodesGreetAsWhatTheyAre) {
    const wire::ControlMessage client = wire::Hello{.peer = wire::PeerKind::Client};
    const wire::ControlMessage node = wire::Hello{.peer = wire::PeerKind::Node};
    for (const Role role : {Role::Viewer, Role::Editor, Role::Operator}) EXPECT_TRUE(allowed(role, client));
    for (const Role role : {Role::Node, Role::Operator}) EXPECT_TRUE(allowed(role, node));
    for (const Role role : {Role::None, Role::Node}) EXPECT_FALSE(allowed(role, client));
    for (const Role role : {Role::None, Role::Viewer, Role::Editor}) EXPECT_FALSE(allowed(role, node));
}

// With TESSERA_WRITE_DOCS=1 it is written there.
TEST(Roles, AreDocumented) {
    const auto path = test::scenes_folder().parent_path().parent_path() / "docs" / "security.md";
    std::string page;
    {
        std::ifstream file(path);
        page.assign(std::istreambuf_iterator<char>(file), {});
    }
    const std::string begin = "<!-- roles -->\n", end = "<!-- /roles -->";
    const auto from = page.find(begin), to = page.find(end);
    ASSERT_NE(from, std::string::npos);
    ASSERT_NE(to, std::string::npos);
    const auto start = from + begin.size();
    if (std::getenv("TESSERA_WRITE_DOCS") != nullptr)
        std::ofstream(path) << page.substr(0, start) << role_table() << page.substr(to);
    else
        EXPECT_EQ(page.substr(start, to - start), role_table()) << "run this test with TESSERA_WRITE_DOCS=1";
}

}  // namespace
}  // namespace tessera::master
