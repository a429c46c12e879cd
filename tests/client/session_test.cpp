// Sessions: handshake, joining, edits, interruptions.
#include "client/session.h"

#include <gtest/gtest.h>

#include "tests/client/session_fixture.h"

namespace tessera::client {
namespace {

using std::chrono::milliseconds;

class SessionTest : public WithScriptedMaster {};

// Long in total, though each string is short.
std::vector<scene::Entry> many_materials() {
    std::vector<scene::Entry> entries;
    for (std::uint64_t i = 0; i < 4000; ++i) {
        entries.push_back(scene::Create{ObjectId{65536 + i}, scene::Material{.name = std::string(40, 'm')}});
    }
    return entries;
}

TEST_F(SessionTest, SendsHelloAndOpensTheBulkLinkWithItsToken) {
    auto session = connect({.name = "anna", .host = "here", .pid = 42});
    const wire::Hello hello = master_.greet();
    EXPECT_EQ(hello.protocol, wire::ProtocolVersion);
    EXPECT_EQ(hello.peer, wire::PeerKind::Client);
    EXPECT_EQ(hello.name, "anna");
    EXPECT_EQ(hello.pid, 42u);
    EXPECT_EQ(hello.resume_token, 0u);
    session.get().reset();
    EXPECT_EQ(master_.expect<wire::Goodbye>().units_sent.size(), 0u);
}

TEST_F(SessionTest, HeartbeatsContinueWhileTheCallerIsIdle) {
    auto session = connect();
    master_.greet({.peer_number = 7,
                   .token = 70,
                   .epoch = 1,
                   .heartbeat_interval = milliseconds(20),
                   .missed_heartbeats = 1000});
    const auto idle = session.get();
    EXPECT_GE(master_.count_heartbeats(milliseconds(400)), 5);
}

TEST_F(SessionTest, ReportsQueuePositionsUntilTheSceneIsOpen) {
    const auto session = connected();
    std::vector<std::uint32_t> places;
    auto joining = in_background([&] {
        return session->join({.title = "a",
                              .exclusive = true,
                              .on_place = [&](std::uint32_t place) { places.push_back(place); }},
                             {});
    });
    EXPECT_FALSE(master_.expect<wire::JoinScene>().no_wait);
    master_.send(wire::SceneJoined{.queue_position = 2});
    master_.send(wire::SceneJoined{.queue_position = 1});
    master_.send(Scene);
    const auto scene = std::get<Joined>(joining.get());
    EXPECT_EQ(scene.version, (Version{1, 5}));
    EXPECT_EQ(scene.first_id, ObjectId{65536});
    EXPECT_EQ(scene.end_id, ObjectId{65636});
    EXPECT_EQ(places, (std::vector<std::uint32_t>{2, 1}));
}

TEST_F(SessionTest, BusyMasterIsAnOutcomeWithoutWaiting) {
    const auto session = connected();
    auto joining =
        in_background([&] { return session->join({.exclusive = true, .when_busy = WhenBusy::GiveUp}, {}); });
    EXPECT_TRUE(master_.expect<wire::JoinScene>().no_wait);
    master_.send(wire::Refusal{"come back later"});
    EXPECT_EQ(std::get<Busy>(joining.get()).reason, "come back later");
}

TEST_F(SessionTest, OtherRefusalsAreErrors) {
    const auto session = connected();
    auto joining = in_background([&] { return session->join({.exclusive = true}, {}); });
    master_.expect<wire::JoinScene>();
    master_.send(wire::Refusal{"the role viewer may not do this"});
    expect_error(joining, ErrorCode::Refused);
}

TEST_F(SessionTest, WaitingInTheQueueCanBeStopped) {
    const auto session = connected();
    std::stop_source stop;
    auto joining = in_background([&] { return session->join({.exclusive = true}, stop.get_token()); });
    master_.expect<wire::JoinScene>();
    stop.request_stop();
    EXPECT_TRUE(std::holds_alternative<Stopped>(joining.get()));
}

TEST_F(SessionTest, ShortEditIsOneMessage) {
    const auto session = joined();
    auto submitted = in_background([&] { return session->submit(material(10)); });
    const auto request = master_.expect<wire::SubmitEdit>();
    EXPECT_EQ(request.edit.sequence, 1u);
    ASSERT_EQ(request.edit.entries.size(), 1u);
    EXPECT_EQ(scene::id(request.edit.entries[0]), ObjectId{65536});
    master_.send(wire::EditReply{.sequence = 1, .result = {.accepted = true, .version = {1, 2}}});
    const auto result = submitted.get();
    EXPECT_TRUE(result.accepted);
    EXPECT_EQ(result.version, (Version{1, 2}));
}

TEST_F(SessionTest, LongEditIsABlobFetchedInChunks) {
    const auto session = joined();
    const auto entries = many_materials();
    auto submitted = in_background([&] { return session->submit(entries); });
    const auto request = master_.expect<wire::SubmitEditByBlob>();
    EXPECT_GT(request.blob.byte_size, net::ControlLimit);
    std::vector<std::byte> bytes;
    while (bytes.size() < request.blob.byte_size) {
        master_.send(wire::BlobRequest{request.blob.hash, bytes.size()});
        const auto chunk = master_.expect_bulk<wire::BlobChunk>();
        ASSERT_EQ(chunk.offset, bytes.size());
        ASSERT_FALSE(chunk.data.empty());
        bytes.insert(bytes.end(), chunk.data.begin(), chunk.data.end());
    }
    EXPECT_EQ(blake2b(bytes), request.blob.hash);
    const auto edit = wire::decode_edit(bytes);
    ASSERT_TRUE(edit) << edit.error().what();
    EXPECT_EQ(edit->entries.size(), entries.size());
    master_.send(wire::EditReply{.sequence = 1, .result = {.accepted = true, .version = {1, 2}}});
    EXPECT_TRUE(submitted.get().accepted);
}

TEST_F(SessionTest, ServesBlobsAndReportsAbsentOnes) {
    const auto session = joined();
    const scene::BlobPtr blob = blobs_->insert(std::vector<std::byte>(100, std::byte{3}));
    master_.send(wire::BlobRequest{blob->hash(), 40});
    const auto chunk = master_.expect_bulk<wire::BlobChunk>();
    EXPECT_EQ(chunk.total, 100u);
    EXPECT_EQ(chunk.data.size(), 60u);
    master_.send(wire::BlobRequest{Hash256{}, 0});
    EXPECT_EQ(master_.expect_bulk<wire::BlobAbsent>().hash, Hash256{});
}

TEST_F(SessionTest, RejectedEditReturnsTheReasons) {
    const auto session = joined();
    auto submitted = in_background([&] { return session->submit(material(1)); });
    master_.expect<wire::SubmitEdit>();
    master_.send(wire::EditReply{
        .sequence = 1, .result = {.accepted = false, .version = {1, 1}, .problems = {"no such id"}}});
    const auto result = submitted.get();
    EXPECT_FALSE(result.accepted);
    EXPECT_EQ(result.problems, std::vector<std::string>{"no such id"});
}

TEST_F(SessionTest, MasterWithoutAnswerIsUnavailable) {
    auto session = connect({.connect_limit = milliseconds(200)});
    expect_error(session, ErrorCode::Unavailable);
}

TEST_F(SessionTest, RefusalHasAReason) {
    auto session = connect();
    master_.expect<wire::Hello>();
    master_.send(wire::Refusal{"another protocol"});
    expect_error(session, ErrorCode::Refused);
}

TEST_F(SessionTest, UnansweredEditIsResentAfterReconnect) {
    const auto session = joined({}, quick_welcome());
    auto submitted = in_background([&] { return session->submit(material(3)); });
    EXPECT_EQ(master_.expect<wire::SubmitEdit>().edit.sequence, 1u);
    master_.greet(quick_welcome());
    EXPECT_EQ(master_.expect<wire::SubmitEdit>().edit.sequence, 1u);
    master_.send(wire::EditReply{.sequence = 1, .result = {.accepted = true, .version = {1, 2}}});
    EXPECT_TRUE(submitted.get().accepted);
}

TEST_F(SessionTest, UnknownPeerSendsHelloAgainWithItsToken) {
    auto connecting = connect();
    wire::Welcome welcome = quick_welcome();
    welcome.missed_heartbeats = 1000;
    master_.greet(welcome);
    const auto session = connecting.get();
    std::this_thread::sleep_for(milliseconds(220));  // greetings are an interval apart
    master_.send(wire::Unknown{});
    EXPECT_EQ(master_.expect<wire::Hello>().resume_token, 70u);
    EXPECT_EQ(reconnects_, 0);
}

TEST_F(SessionTest, MalformedMessagesAreIgnored) {
    const auto session = connected();
    for (const std::size_t length : {0u, 1u, 7u, 64u, 5000u}) {
        master_.send_raw(net::Link::Control, net::Bytes(length, std::byte{0xA5}));
        master_.send_raw(net::Link::Bulk, net::Bytes(length, std::byte{0x5A}));
    }
    auto status = in_background([&] { return session->status(); });
    master_.expect<wire::StatusRequest>();
    session::ClusterStatus reply{.software = "x"};
    reply.nodes.push_back({.summary = {.id = NodeId{3}, .name = "n"}, .phase = session::NodePhase::Building});
    master_.send(wire::StatusReply{reply});
    const session::ClusterStatus heard = status.get();
    EXPECT_EQ(heard.software, "x");
    ASSERT_EQ(heard.nodes.size(), 1u);
    EXPECT_EQ(heard.nodes[0].phase, session::NodePhase::Building);
}

}  // namespace
}  // namespace tessera::client
