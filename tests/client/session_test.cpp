// The session against a master that the test plays, over the loopback.
#include "client/session.h"

#include <gtest/gtest.h>

#include <atomic>
#include <functional>
#include <future>

#include "client/channel_session.h"
#include "client/render.h"
#include "tests/client/scripted_master.h"

namespace tessera::client {
namespace {

using frame::Channel;
using std::chrono::milliseconds;

class SessionTest : public testing::Test {
  protected:
    std::future<std::unique_ptr<Session>> connect(SessionSettings settings = {}) {
        return std::async(std::launch::async, [this, settings] {
            return make_session(
                hub_.client(net::Role::Editor), [this] { ++reconnects_; }, blobs_, clock_, settings);
        });
    }
    std::unique_ptr<Session> connected() {
        auto session = connect();
        master_.greet();
        return session.get();
    }
    // In an exclusive scene.
    std::unique_ptr<Session> joined(SessionSettings settings = {},
                                    const std::optional<wire::Welcome>& welcome = {}) {
        auto connecting = connect(std::move(settings));
        welcome ? master_.greet(*welcome) : master_.greet();
        auto session = connecting.get();
        auto joining = std::async(std::launch::async,
                                  [&] { return session->join({.title = "a", .exclusive = true}, {}); });
        EXPECT_TRUE(master_.expect<wire::JoinScene>().exclusive);
        master_.send(Scene);
        EXPECT_TRUE(std::holds_alternative<Joined>(joining.get()));
        return session;
    }
    // Takes the request for a view.
    wire::RequestView view_requested() {
        const auto request = master_.expect<wire::RequestView>();
        master_.send(wire::RequestDone{request.request, true, {}});
        return request;
    }
    static wire::Welcome quick_welcome() {
        return {.peer_number = 7,
                .token = 70,
                .epoch = 1,
                .heartbeat_interval = milliseconds(200),
                .missed_heartbeats = 3};
    }

    static inline const wire::SceneJoined Scene{
        .version = {1, 5}, .first_id = 65536, .id_count = 100, .title = "a", .name = "client"};

    SteadyClock clock_;
    std::shared_ptr<scene::BlobStore> blobs_ = std::make_shared<scene::BlobStore>();
    net::LoopbackHub hub_;
    ScriptedMaster master_{hub_};
    std::atomic<int> reconnects_ = 0;
};

template <class Call>
auto in_background(Call call) {
    return std::async(std::launch::async, std::move(call));
}

template <class Future>
void expect_error(Future& future, ErrorCode code) {
    try {
        (void)future.get();
        FAIL() << "no error";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), code) << error.what();
    }
}

std::vector<scene::Entry> material(std::size_t name_length) {
    return {scene::Create{ObjectId{65536}, scene::Material{.name = std::string(name_length, 'm')}}};
}

// Long, though each string is short.
std::vector<scene::Entry> many_materials() {
    std::vector<scene::Entry> entries;
    for (std::uint64_t i = 0; i < 4000; ++i) {
        entries.push_back(scene::Create{ObjectId{65536 + i}, scene::Material{.name = std::string(40, 'm')}});
    }
    return entries;
}

session::ViewRequest small_view() {
    session::ViewRequest request{.stop = {.spp = 2}, .film = true};
    request.view.width = 8;
    request.view.height = 4;
    request.view.window = {2, 1, 4, 3};
    request.view.channels = {Channel::Depth};
    return request;
}

constexpr std::uint64_t FrameNumber = 5;

wire::FrameHeader header(const wire::RequestView& request, std::uint32_t tiles) {
    const Rect window = tiles == 0 ? Rect{} : request.wanted.view.window;
    return {.view = request.number,
            .frame = FrameNumber,
            .film_window = window,
            .film_tiles = tiles,
            .complete = true};
}

wire::ViewDone done(const wire::RequestView& request, session::ViewSummary summary) {
    return {.number = request.number, .frame = FrameNumber, .summary = std::move(summary)};
}

// A tile whose values say where they belong.
wire::FrameTile tile(std::uint32_t index, std::uint32_t count, Rect rect) {
    wire::FrameTile tile{.frame = FrameNumber,
                         .index = index,
                         .count = count,
                         .film = frame::FilmTile(rect, {}, {Channel::Depth})};
    for (std::size_t i = 0; i < rect.pixel_count(); ++i) {
        const auto width = static_cast<std::size_t>(rect.width);
        tile.film.counts[i] = 2;
        tile.film.planes[i] =
            float(100 * (std::size_t(rect.y) + i / width) + std::size_t(rect.x) + i % width);
    }
    tile.film.nonfinite_samples = 1;
    return tile;
}

TEST_F(SessionTest, GreetsAsAClientAndOpensTheBulkLinkWithItsToken) {
    auto session = connect({.name = "somebody", .host = "here", .pid = 42});
    const wire::Hello hello = master_.greet();
    EXPECT_EQ(hello.protocol, wire::ProtocolVersion);
    EXPECT_EQ(hello.peer, wire::PeerKind::Client);
    EXPECT_EQ(hello.name, "somebody");
    EXPECT_EQ(hello.pid, 42u);
    EXPECT_EQ(hello.resume_token, 0u);
    session.get().reset();
    EXPECT_EQ(master_.expect<wire::Goodbye>().units_sent.size(), 0u);
}

TEST_F(SessionTest, HeartbeatsGoOnWhileTheCallerIsAway) {
    auto session = connect();
    master_.greet({.peer_number = 7,
                   .token = 70,
                   .epoch = 1,
                   .heartbeat_interval = milliseconds(20),
                   .missed_heartbeats = 1000});
    const auto idle = session.get();
    EXPECT_GE(master_.count_heartbeats(milliseconds(400)), 5);
}

TEST_F(SessionTest, TellsThePlacesInTheQueueUntilTheSceneIsOpen) {
    const auto session = connected();
    std::vector<std::uint32_t> places;
    auto joining = in_background([&] {
        return session->join({.title = "a",
                              .exclusive = true,
                              .on_place = [&](std::uint32_t place) { places.push_back(place); }},
                             {});
    });
    EXPECT_FALSE(master_.expect<wire::JoinScene>().no_wait);
    master_.send(wire::SceneJoined{.queue_place = 2});
    master_.send(wire::SceneJoined{.queue_place = 1});
    master_.send(Scene);
    const auto scene = std::get<Joined>(joining.get());
    EXPECT_EQ(scene.version, (Version{1, 5}));
    EXPECT_EQ(scene.first_id, ObjectId{65536});
    EXPECT_EQ(scene.end_id, ObjectId{65636});
    EXPECT_EQ(places, (std::vector<std::uint32_t>{2, 1}));
}

TEST_F(SessionTest, ABusyMasterIsAnOutcomeWhenNobodyWantsToWait) {
    const auto session = connected();
    auto joining =
        in_background([&] { return session->join({.exclusive = true, .when_busy = WhenBusy::GiveUp}, {}); });
    EXPECT_TRUE(master_.expect<wire::JoinScene>().no_wait);
    master_.send(wire::Refusal{"come back later"});
    EXPECT_EQ(std::get<Busy>(joining.get()).reason, "come back later");
}

TEST_F(SessionTest, ARefusalElsewhereIsAnError) {
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

TEST_F(SessionTest, AShortEditGoesInOneMessage) {
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

TEST_F(SessionTest, ALongEditGoesAsABlobInChunksThatTheMasterAsksFor) {
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

TEST_F(SessionTest, ServesTheBlobsOfItsStoreAndSaysWhichItLacks) {
    const auto session = joined();
    const scene::BlobPtr blob = blobs_->insert(std::vector<std::byte>(100, std::byte{3}));
    master_.send(wire::BlobRequest{blob->hash(), 40});
    const auto chunk = master_.expect_bulk<wire::BlobChunk>();
    EXPECT_EQ(chunk.total, 100u);
    EXPECT_EQ(chunk.data.size(), 60u);
    master_.send(wire::BlobRequest{Hash256{}, 0});
    EXPECT_EQ(master_.expect_bulk<wire::BlobAbsent>().hash, Hash256{});
}

TEST_F(SessionTest, AnEditThatIsNotTakenComesBackWithReasons) {
    const auto session = joined();
    auto submitted = in_background([&] { return session->submit(material(1)); });
    master_.expect<wire::SubmitEdit>();
    master_.send(wire::EditReply{
        .sequence = 1, .result = {.accepted = false, .version = {1, 1}, .problems = {"no such id"}}});
    const auto result = submitted.get();
    EXPECT_FALSE(result.accepted);
    EXPECT_EQ(result.problems, std::vector<std::string>{"no such id"});
}

TEST_F(SessionTest, PutsTheTilesTogetherInAnyOrderAlsoBeforeTheSummary) {
    const auto session = joined();
    std::vector<std::uint64_t> heard;
    auto rendered = in_background([&] {
        return render(*session, small_view(),
                      [&](const session::ViewProgress& progress) { heard.push_back(progress.samples); }, {});
    });
    const auto request = view_requested();
    EXPECT_EQ(request.wanted.stop.spp, 2u);
    EXPECT_EQ(request.wanted.view.window, (Rect{2, 1, 4, 3}));
    EXPECT_EQ(request.wanted.frames, session::Frames::Last);
    master_.send(wire::ViewProgress{request.number, {.phase = session::Phase::Rendering, .samples = 9}});
    master_.send(wire::ViewProgress{request.number + 1, {.samples = 1}});  // of no view of ours
    master_.send(header(request, 2));
    master_.send(tile(1, 2, {4, 1, 2, 3}));
    master_.send(tile(1, 2, {4, 1, 2, 3}));
    master_.send(done(request, {.rays = 12, .samples = 24}));
    master_.send(tile(0, 2, {2, 1, 2, 3}));
    const ViewResult result = rendered.get();
    ASSERT_TRUE(result.film());
    EXPECT_EQ(result.summary.rays, 12u);
    EXPECT_EQ(result.film()->rect, (Rect{2, 1, 4, 3}));
    EXPECT_EQ(result.film()->nonfinite_samples, 2u);
    for (std::int32_t y = 1; y < 4; ++y) {
        for (std::int32_t x = 2; x < 6; ++x) {
            const auto index = static_cast<std::size_t>(4 * (y - 1) + x - 2);
            EXPECT_EQ(result.film()->counts[index], 2u);
            EXPECT_EQ(result.film()->planes[index], float(100 * y + x));
        }
    }
    EXPECT_EQ(heard, std::vector<std::uint64_t>{9});
    const auto end = master_.expect<wire::EndView>();
    EXPECT_EQ(end.number, request.number);
    EXPECT_FALSE(end.deliver) << "the master may forget it";
}

// More than the link takes at a time.
TEST_F(SessionTest, NoTileOfAFloodIsLost) {
    const auto session = joined();
    session::ViewRequest wanted = small_view();
    wanted.view.window = {0, 0, 30, 30};
    wanted.view.width = wanted.view.height = 30;
    auto rendered = in_background([&] { return render(*session, wanted, {}, {}); });
    const auto request = view_requested();
    std::vector<net::Bytes> tiles;
    for (std::int32_t i = 0; i < 900; ++i) {
        tiles.push_back(wire::encode(
            wire::BulkMessage(tile(static_cast<std::uint32_t>(i), 900, {i % 30, i / 30, 1, 1}))));
    }
    master_.send(header(request, 900));
    for (net::Bytes& bytes : tiles) master_.send_raw(net::Link::Bulk, std::move(bytes));
    master_.send(done(request, {.rays = 1, .samples = 1800}));
    ASSERT_EQ(rendered.wait_for(std::chrono::seconds(30)), std::future_status::ready);
    EXPECT_EQ(rendered.get().film()->nonfinite_samples, 900u);
}

TEST_F(SessionTest, AStopAsksForWhatIsThere) {
    const auto session = joined();
    std::stop_source stop;
    auto rendered = in_background([&] { return render(*session, small_view(), {}, stop.get_token()); });
    const auto request = view_requested();
    stop.request_stop();
    const auto end = master_.expect<wire::EndView>();
    EXPECT_EQ(end.number, request.number);
    EXPECT_TRUE(end.deliver);
    master_.send(done(request, {.outcome = session::Outcome::Stopped, .samples = 2}));
    master_.send(header(request, 2));
    master_.send(tile(0, 2, {2, 1, 4, 1}));
    master_.send(tile(1, 2, {2, 2, 4, 2}));
    const ViewResult result = rendered.get();
    EXPECT_EQ(result.summary.outcome, session::Outcome::Stopped);
    EXPECT_EQ(result.film()->counts[0], 2u);
}

TEST_F(SessionTest, AStopBeforeTheRequestFollowsIt) {
    const auto session = joined();
    std::stop_source stop;
    stop.request_stop();
    auto rendered = in_background([&] { return render(*session, small_view(), {}, stop.get_token()); });
    const auto request = view_requested();
    EXPECT_TRUE(master_.expect<wire::EndView>().deliver);
    master_.send(done(request, {.outcome = session::Outcome::Stopped}));
    master_.send(header(request, 0));
    EXPECT_FALSE(rendered.get().film());
}

TEST_F(SessionTest, AViewThatIsRefusedIsAnError) {
    const auto session = joined();
    auto rendered = in_background([&] { return render(*session, small_view(), {}, {}); });
    const auto request = master_.expect<wire::RequestView>();
    master_.send(wire::RequestDone{request.request, false, "no such filter"});
    expect_error(rendered, ErrorCode::Refused);
}

// Outside of the window, twice the same place, fewer pixels than it has, another count than the header's.
TEST_F(SessionTest, TilesThatDoNotFitAreAnError) {
    const std::vector<std::vector<wire::FrameTile>> attacks{
        {tile(0, 1, {0, 0, 4, 3})}, {tile(0, 1, {5, 3, 2, 1})},
        {tile(0, 1, {1, 1, 1, 1})}, {tile(0, 1, {2, 1, 4, 2})},
        {tile(0, 2, {2, 1, 4, 3})}, {tile(0, 2, {2, 1, 4, 3}), tile(1, 2, {2, 1, 4, 3})},
    };
    for (const auto& tiles : attacks) {
        net::LoopbackHub hub;
        ScriptedMaster master(hub);
        auto connecting = in_background(
            [&] { return make_session(hub.client(net::Role::Editor), {}, blobs_, clock_, {}); });
        master.greet();
        const auto session = connecting.get();
        auto joining = in_background([&] { return session->join({.exclusive = true}, {}); });
        master.expect<wire::JoinScene>();
        master.send(Scene);
        (void)joining.get();
        auto rendered = in_background([&] { return render(*session, small_view(), {}, {}); });
        const auto request = master.expect<wire::RequestView>();
        master.send(wire::RequestDone{request.request, true, {}});
        master.send(header(request, tiles.size() == 2 ? 2 : 1));
        for (const wire::FrameTile& part : tiles) master.send(part);
        expect_error(rendered, ErrorCode::InvalidInput);
    }
}

// A header that promises more than any frame has is no message at all; memory is taken for what has come.
TEST_F(SessionTest, AHeaderThatLiesCostsNoMemory) {
    const auto session = joined({.lost_limit = milliseconds(1000)});
    auto rendered = in_background([&] { return render(*session, small_view(), {}, {}); });
    const auto request = view_requested();
    wire::FrameHeader absurd = header(request, 1);
    absurd.film_window = {0, 0, 65536, 65536};
    EXPECT_FALSE(wire::decode_bulk(wire::encode(wire::BulkMessage(absurd))));
    absurd.film_window = {0, 0, 16384, 16384};
    absurd.film_tiles = 4096;
    absurd.picture_bytes = std::uint64_t{1} << 32;
    master_.send(absurd);
    master_.send(tile(0, 4096, {0, 0, 8, 8}));
    expect_error(rendered, ErrorCode::Unavailable);
}

TEST_F(SessionTest, AMasterThatNeverAnswersIsUnavailable) {
    auto session = connect({.connect_limit = milliseconds(200)});
    expect_error(session, ErrorCode::Unavailable);
}

TEST_F(SessionTest, AMasterThatRefusesSaysWhy) {
    auto session = connect();
    master_.expect<wire::Hello>();
    master_.send(wire::Refusal{"another protocol"});
    expect_error(session, ErrorCode::Refused);
}

TEST_F(SessionTest, AMasterThatLeavesForGoodEndsTheCall) {
    const auto session = joined({.lost_limit = milliseconds(500)});
    auto rendered = in_background([&] { return render(*session, small_view(), {}, {}); });
    (void)view_requested();
    master_.send(wire::Goodbye{"the master stops", {}});
    try {
        (void)rendered.get();
        FAIL() << "no error";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::Unavailable);
        EXPECT_NE(std::string(error.what()).find("did not come back: the master stops"), std::string::npos)
            << error.what();
    }
}

TEST_F(SessionTest, AfterSilenceItComesBackAsTheSameAndTheFrameGoesOn) {
    std::vector<bool> away;
    const auto session = joined({.on_away = [&](bool is_away) { away.push_back(is_away); }}, quick_welcome());
    auto rendered = in_background([&] { return render(*session, small_view(), {}, {}); });
    (void)view_requested();
    // Nothing is said: the next word is a greeting, over new sockets.
    const wire::Hello again = master_.greet(quick_welcome());
    EXPECT_EQ(again.resume_token, 70u);
    EXPECT_GE(reconnects_, 1);
    const auto request = master_.expect<wire::RequestView>();
    EXPECT_EQ(request.wanted.view.window, (Rect{2, 1, 4, 3}));
    master_.send(header(request, 1));
    master_.send(tile(0, 1, {2, 1, 4, 3}));
    master_.send(done(request, {.samples = 24}));
    EXPECT_EQ(rendered.get().summary.samples, 24u);
    EXPECT_EQ(away, (std::vector{true, false}));
}

TEST_F(SessionTest, AnEditUnderWayIsSentAgainAfterABreak) {
    const auto session = joined({}, quick_welcome());
    auto submitted = in_background([&] { return session->submit(material(3)); });
    EXPECT_EQ(master_.expect<wire::SubmitEdit>().edit.sequence, 1u);
    master_.greet(quick_welcome());
    EXPECT_EQ(master_.expect<wire::SubmitEdit>().edit.sequence, 1u);
    master_.send(wire::EditReply{.sequence = 1, .result = {.accepted = true, .version = {1, 2}}});
    EXPECT_TRUE(submitted.get().accepted);
}

// It was started anew, with what it had written down: the scene is there, and the view is requested again.
TEST_F(SessionTest, AMasterThatWasStartedAnewWithTheSceneGoesOnWithTheFrame) {
    const auto session = joined({}, quick_welcome());
    auto submitted = in_background([&] { return session->submit(material(3)); });
    (void)master_.expect<wire::SubmitEdit>();
    master_.send(wire::EditReply{.sequence = 1, .result = {.accepted = true, .version = {1, 2}}});
    EXPECT_TRUE(submitted.get().accepted);
    auto rendered = in_background([&] { return render(*session, small_view(), {}, {}); });
    (void)view_requested();
    wire::Welcome stranger = quick_welcome();
    stranger.peer_number = 8;
    master_.greet(stranger);
    (void)master_.expect<wire::JoinScene>();
    wire::SceneJoined same = Scene;
    same.last_sequence = 1;
    master_.send(same);
    const auto request = master_.expect<wire::RequestView>();
    master_.send(header(request, 0));
    master_.send(done(request, {.samples = 3}));
    EXPECT_EQ(rendered.get().summary.samples, 3u);
}

TEST_F(SessionTest, AMasterThatHasLostTheSceneEndsTheFrame) {
    const auto session = joined({}, quick_welcome());
    auto submitted = in_background([&] { return session->submit(material(3)); });
    (void)master_.expect<wire::SubmitEdit>();
    master_.send(wire::EditReply{.sequence = 1, .result = {.accepted = true, .version = {1, 2}}});
    EXPECT_TRUE(submitted.get().accepted);
    auto rendered = in_background([&] { return render(*session, small_view(), {}, {}); });
    (void)view_requested();
    wire::Welcome stranger = quick_welcome();
    stranger.peer_number = 8;
    master_.greet(stranger);
    EXPECT_TRUE(master_.expect<wire::JoinScene>().exclusive);
    master_.send(Scene);
    expect_error(rendered, ErrorCode::Unavailable);
}

TEST_F(SessionTest, AnUnknownPeerGreetsAgainWithItsToken) {
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

TEST_F(SessionTest, NonsenseOnEitherLinkIsIgnored) {
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
