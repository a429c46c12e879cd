// A view's summary fits into a message for any number of nodes.
#include "master/render/view_summary.h"

#include <gtest/gtest.h>

#include "mediator/wire/envelope.h"

namespace tessera::master {
namespace {

wire::ViewDone done_by(std::uint64_t nodes) {
    wire::ViewDone done{.number = 3, .frame = 4};
    for (std::uint64_t i = 1; i <= nodes; ++i) {
        done.summary.nodes.push_back({.id = NodeId{i},
                                      .name = "node-" + std::to_string(i) + std::string(60, 'n'),
                                      .host = std::string(60, 'h'),
                                      .backend = "embree",
                                      .kind = std::string(60, 'k'),
                                      .samples = i});
    }
    return done;
}

session::ViewSummary sent(std::uint64_t nodes) {
    const net::Bytes bytes = encoded(done_by(nodes));
    EXPECT_TRUE(wire::fits_control(bytes));
    const auto message = wire::decode_control(bytes);
    EXPECT_TRUE(message);
    return std::get<wire::ViewDone>(*message).summary;
}

TEST(ViewSummary, ListsFewNodesInOrder) {
    const session::ViewSummary summary = sent(9);
    ASSERT_EQ(summary.nodes.size(), 9u);
    EXPECT_EQ(summary.nodes[0].id, NodeId{1});
    EXPECT_TRUE(summary.picture.notes.empty());
}

TEST(ViewSummary, ListsTheBusiestOfManyNodesWithANote) {
    const session::ViewSummary summary = sent(1024);
    ASSERT_GE(summary.nodes.size(), 128u);
    EXPECT_EQ(summary.nodes[0].id, NodeId{1024});
    ASSERT_EQ(summary.picture.notes.size(), 1u);
    EXPECT_NE(summary.picture.notes[0].find("of 1024 nodes are not listed"), std::string::npos);
}

}  // namespace
}  // namespace tessera::master
