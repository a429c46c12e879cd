#include "master/peers/roles.h"

#include <gtest/gtest.h>

namespace tessera::master {
namespace {

using net::Role;

TEST(Roles, ViewerIsReadOnly) {
    EXPECT_TRUE(allowed(Role::Viewer, wire::ControlMessage(wire::StatusRequest{})));
    EXPECT_TRUE(allowed(Role::Viewer, wire::ControlMessage(wire::Hello{.peer = wire::PeerKind::Client})));
    EXPECT_FALSE(allowed(Role::Viewer, wire::ControlMessage(wire::Hello{.peer = wire::PeerKind::Node})));
    EXPECT_FALSE(allowed(Role::Viewer, wire::ControlMessage(wire::CloseScene{})));
    EXPECT_FALSE(allowed(Role::Viewer, wire::ControlMessage(wire::SubmitEdit{})));
    EXPECT_FALSE(allowed(Role::Viewer, wire::BulkMessage(wire::BlobChunk{})));
    EXPECT_FALSE(allowed(Role::Viewer, wire::BulkMessage(wire::FilmPart{})));
}

TEST(Roles, NodeRendersButDoesNotEdit) {
    EXPECT_TRUE(allowed(Role::Node, wire::ControlMessage(wire::Hello{.peer = wire::PeerKind::Node})));
    EXPECT_FALSE(allowed(Role::Node, wire::ControlMessage(wire::Hello{.peer = wire::PeerKind::Client})));
    EXPECT_TRUE(allowed(Role::Node, wire::BulkMessage(wire::FilmPart{})));
    EXPECT_TRUE(allowed(Role::Node, wire::BulkMessage(wire::BlobRequest{})));
    EXPECT_FALSE(allowed(Role::Node, wire::ControlMessage(wire::RequestView{})));
    EXPECT_FALSE(allowed(Role::Node, wire::ControlMessage(wire::SubmitEdit{})));
    EXPECT_FALSE(allowed(Role::Node, wire::BulkMessage(wire::BlobChunk{})));
}

TEST(Roles, EditorEditsButDoesNotRender) {
    EXPECT_TRUE(allowed(Role::Editor, wire::ControlMessage(wire::SubmitEdit{})));
    EXPECT_TRUE(allowed(Role::Editor, wire::BulkMessage(wire::BlobChunk{})));
    EXPECT_FALSE(allowed(Role::Editor, wire::BulkMessage(wire::FilmPart{})));
    EXPECT_FALSE(allowed(Role::Editor, wire::ControlMessage(wire::VersionReport{})));
}

TEST(Roles, NoRoleMaySendMasterMessages) {
    for (const net::Role role : {Role::None, Role::Viewer, Role::Editor, Role::Node, Role::Operator}) {
        EXPECT_FALSE(allowed(role, wire::ControlMessage(wire::Welcome{})));
        EXPECT_FALSE(allowed(role, wire::ControlMessage(wire::Work{})));
        EXPECT_FALSE(allowed(role, wire::ControlMessage(wire::Changes{})));
        EXPECT_FALSE(allowed(role, wire::BulkMessage(wire::FrameTile{})));
    }
    EXPECT_FALSE(allowed(Role::None, wire::ControlMessage(wire::Hello{})));
}

}  // namespace
}  // namespace tessera::master
