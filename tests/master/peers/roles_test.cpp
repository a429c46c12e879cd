#include "master/peers/roles.h"

#include <gtest/gtest.h>

namespace tessera::master {
namespace {

using enum net::Role;

TEST(Roles, AViewerOnlyLooks) {
    EXPECT_TRUE(allowed(Viewer, wire::ControlMessage(wire::StatusRequest{})));
    EXPECT_TRUE(allowed(Viewer, wire::ControlMessage(wire::Hello{.peer = wire::PeerKind::Client})));
    EXPECT_FALSE(allowed(Viewer, wire::ControlMessage(wire::Hello{.peer = wire::PeerKind::Node})));
    EXPECT_FALSE(allowed(Viewer, wire::ControlMessage(wire::OpenScene{})));
    EXPECT_FALSE(allowed(Viewer, wire::ControlMessage(wire::SubmitEdit{})));
    EXPECT_FALSE(allowed(Viewer, wire::BulkMessage(wire::BlobChunk{})));
    EXPECT_FALSE(allowed(Viewer, wire::BulkMessage(wire::FilmPart{})));
}

TEST(Roles, ANodeRendersAndDoesNotEdit) {
    EXPECT_TRUE(allowed(Node, wire::ControlMessage(wire::Hello{.peer = wire::PeerKind::Node})));
    EXPECT_FALSE(allowed(Node, wire::ControlMessage(wire::Hello{.peer = wire::PeerKind::Client})));
    EXPECT_TRUE(allowed(Node, wire::BulkMessage(wire::FilmPart{})));
    EXPECT_TRUE(allowed(Node, wire::BulkMessage(wire::BlobRequest{})));
    EXPECT_FALSE(allowed(Node, wire::ControlMessage(wire::StartJob{})));
    EXPECT_FALSE(allowed(Node, wire::ControlMessage(wire::SubmitEdit{})));
    EXPECT_FALSE(allowed(Node, wire::BulkMessage(wire::BlobChunk{})));
}

TEST(Roles, AnEditorEditsAndDoesNotPretendToRender) {
    EXPECT_TRUE(allowed(Editor, wire::ControlMessage(wire::SubmitEdit{})));
    EXPECT_TRUE(allowed(Editor, wire::BulkMessage(wire::BlobChunk{})));
    EXPECT_FALSE(allowed(Editor, wire::BulkMessage(wire::FilmPart{})));
    EXPECT_FALSE(allowed(Editor, wire::ControlMessage(wire::VersionReport{})));
}

TEST(Roles, NobodyMayPlayTheMaster) {
    for (const net::Role role : {None, Viewer, Editor, Node, Operator}) {
        EXPECT_FALSE(allowed(role, wire::ControlMessage(wire::Welcome{})));
        EXPECT_FALSE(allowed(role, wire::ControlMessage(wire::Work{})));
        EXPECT_FALSE(allowed(role, wire::ControlMessage(wire::Changes{})));
        EXPECT_FALSE(allowed(role, wire::BulkMessage(wire::FrameTile{})));
    }
    EXPECT_FALSE(allowed(None, wire::ControlMessage(wire::Hello{})));
}

}  // namespace
}  // namespace tessera::master
