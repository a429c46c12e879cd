// The session against a master that the test plays, over the loopback.
#include "client/session.h"

#include <gtest/gtest.h>

#include <atomic>
#include <functional>
#include <future>

#include "tests/client/scripted_master.h"

namespace tessera::client {
namespace {

using frame::Channel;
using std::chrono::milliseconds;

class SessionTest : public testing::Test {
  protected:
    std::future<std::unique_ptr<Session>> connect(SessionSettings settings = {}) {
        return std::async(std::launch::async, [this, settings] {
            return std::make_unique<Session>(
                hub_.client(net::Role::Editor), [this] { ++reconnects_; }, blobs_, clock_, settings);
        });
    }
    std::unique_ptr<Session> connected() {
        auto session = connect();
        master_.greet();
        return session.get();
    }
    static wire::Welcome quick_welcome() {
        return {.peer_number = 7,
                .token = 70,
                .epoch = 1,
                .heartbeat_interval = milliseconds(200),
                .missed_heartbeats = 3};
    }

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

JobRequest small_job() {
    JobRequest request;
    request.view.width = 8;
    request.view.height = 4;
    request.view.window = {2, 1, 4, 3};
    request.view.channels = {Channel::Depth};
    request.spp = 2;
    return request;
}

// A tile whose values say where they belong.
wire::FrameTile tile(JobId job, std::uint32_t index, std::uint32_t count, Rect rect) {
    wire::FrameTile tile{
        .job = job, .index = index, .count = count, .film = frame::FilmTile(rect, {}, {Channel::Depth})};
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
    auto opened = in_background([&] {
        return session->open_scene("a", WhenBusy::Queue,
                                   [&](std::uint32_t place) { places.push_back(place); }, {});
    });
    EXPECT_FALSE(master_.expect<wire::OpenScene>().no_wait);
    master_.send(wire::QueuePlace{2});
    master_.send(wire::QueuePlace{1});
    master_.send(wire::SceneOpened{{1, 5}, 65536, 100});
    const auto scene = std::get<OpenedScene>(opened.get());
    EXPECT_EQ(scene.version, (Version{1, 5}));
    EXPECT_EQ(scene.first_id, ObjectId{65536});
    EXPECT_EQ(scene.end_id, ObjectId{65636});
    EXPECT_EQ(places, (std::vector<std::uint32_t>{2, 1}));
}

TEST_F(SessionTest, ABusyMasterIsAnOutcomeWhenNobodyWantsToWait) {
    const auto session = connected();
    auto opened = in_background([&] { return session->open_scene("a", WhenBusy::GiveUp, {}, {}); });
    EXPECT_TRUE(master_.expect<wire::OpenScene>().no_wait);
    master_.send(wire::Refusal{"come back later"});
    EXPECT_EQ(std::get<Busy>(opened.get()).reason, "come back later");
}

TEST_F(SessionTest, ARefusalElsewhereIsAnError) {
    const auto session = connected();
    auto opened = in_background([&] { return session->open_scene("a", WhenBusy::Queue, {}, {}); });
    master_.expect<wire::OpenScene>();
    master_.send(wire::Refusal{"the role viewer may not do this"});
    expect_error(opened, ErrorCode::Refused);
}

TEST_F(SessionTest, WaitingInTheQueueCanBeStopped) {
    const auto session = connected();
    std::stop_source stop;
    auto opened =
        in_background([&] { return session->open_scene("a", WhenBusy::Queue, {}, stop.get_token()); });
    master_.expect<wire::OpenScene>();
    stop.request_stop();
    EXPECT_TRUE(std::holds_alternative<Stopped>(opened.get()));
}

TEST_F(SessionTest, AShortEditGoesInOneMessage) {
    const auto session = connected();
    auto submitted = in_background([&] { return session->submit(material(10), {}); });
    const auto request = master_.expect<wire::SubmitEdit>();
    EXPECT_EQ(request.edit.sequence, 1u);
    ASSERT_EQ(request.edit.entries.size(), 1u);
    EXPECT_EQ(scene::id(request.edit.entries[0]), ObjectId{65536});
    master_.send(wire::EditReply{.sequence = 1, .accepted = true, .version = {1, 2}, .problems = {}});
    const auto result = submitted.get();
    ASSERT_TRUE(result);
    EXPECT_TRUE(result->accepted);
    EXPECT_EQ(result->version, (Version{1, 2}));
}

TEST_F(SessionTest, ALongEditGoesAsABlobInChunksThatTheMasterAsksFor) {
    const auto session = connected();
    const auto entries = many_materials();
    auto submitted = in_background([&] { return session->submit(entries, {}); });
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
    master_.send(wire::EditReply{.sequence = 1, .accepted = true, .version = {1, 2}, .problems = {}});
    EXPECT_TRUE(submitted.get()->accepted);
}

TEST_F(SessionTest, ServesTheBlobsOfItsStoreAndSaysWhichItLacks) {
    const auto session = connected();
    const scene::BlobPtr blob = blobs_->insert(std::vector<std::byte>(100, std::byte{3}));
    master_.send(wire::BlobRequest{blob->hash(), 40});
    const auto chunk = master_.expect_bulk<wire::BlobChunk>();
    EXPECT_EQ(chunk.total, 100u);
    EXPECT_EQ(chunk.data.size(), 60u);
    master_.send(wire::BlobRequest{Hash256{}, 0});
    EXPECT_EQ(master_.expect_bulk<wire::BlobAbsent>().hash, Hash256{});
}

TEST_F(SessionTest, AnEditThatIsNotTakenComesBackWithReasons) {
    const auto session = connected();
    auto submitted = in_background([&] { return session->submit(material(1), {}); });
    master_.expect<wire::SubmitEdit>();
    master_.send(
        wire::EditReply{.sequence = 1, .accepted = false, .version = {1, 1}, .problems = {"no such id"}});
    const auto result = submitted.get();
    EXPECT_FALSE(result->accepted);
    EXPECT_EQ(result->problems, std::vector<std::string>{"no such id"});
}

TEST_F(SessionTest, PutsTheTilesTogetherInAnyOrderAlsoBeforeTheSummary) {
    const auto session = connected();
    std::vector<std::uint64_t> heard;
    auto rendered = in_background([&] {
        return session->render(small_job(),
                               [&](const Progress& progress) { heard.push_back(progress.samples); }, {});
    });
    const auto start = master_.expect<wire::StartJob>();
    EXPECT_EQ(start.spp, 2u);
    EXPECT_EQ(start.view.window, (Rect{2, 1, 4, 3}));
    master_.send(wire::JobProgress{.job = start.job, .phase = wire::JobPhase::Rendering, .samples = 9});
    master_.send(wire::JobProgress{.job = JobId{start.job.value + 1}, .samples = 1});  // somebody else's
    master_.send(tile(start.job, 1, 2, {4, 1, 2, 3}));
    master_.send(tile(start.job, 1, 2, {4, 1, 2, 3}));
    master_.send(wire::JobDone{.job = start.job, .tiles = 2, .rays = 12, .samples = 24});
    master_.send(tile(start.job, 0, 2, {2, 1, 2, 3}));
    const JobResult result = rendered.get();
    ASSERT_TRUE(result.film);
    EXPECT_EQ(result.rays, 12u);
    EXPECT_EQ(result.film->rect, (Rect{2, 1, 4, 3}));
    EXPECT_EQ(result.film->nonfinite_samples, 2u);
    for (std::int32_t y = 1; y < 4; ++y) {
        for (std::int32_t x = 2; x < 6; ++x) {
            const auto index = static_cast<std::size_t>(4 * (y - 1) + x - 2);
            EXPECT_EQ(result.film->counts[index], 2u);
            EXPECT_EQ(result.film->planes[index], float(100 * y + x));
        }
    }
    EXPECT_EQ(heard, std::vector<std::uint64_t>{9});
}

// More than the link takes at a time.
TEST_F(SessionTest, NoTileOfAFloodIsLost) {
    const auto session = connected();
    JobRequest request = small_job();
    request.view.window = {0, 0, 30, 30};
    request.view.width = request.view.height = 30;
    auto rendered = in_background([&] { return session->render(request, {}, {}); });
    const auto start = master_.expect<wire::StartJob>();
    std::vector<net::Bytes> tiles;
    for (std::int32_t i = 0; i < 900; ++i) {
        tiles.push_back(wire::encode(
            wire::BulkMessage(tile(start.job, static_cast<std::uint32_t>(i), 900, {i % 30, i / 30, 1, 1}))));
    }
    for (net::Bytes& bytes : tiles) master_.send_raw(net::Link::Bulk, std::move(bytes));
    master_.send(wire::JobDone{.job = start.job, .tiles = 900, .rays = 1, .samples = 1800});
    ASSERT_EQ(rendered.wait_for(std::chrono::seconds(30)), std::future_status::ready);
    EXPECT_EQ(rendered.get().film->nonfinite_samples, 900u);
}

TEST_F(SessionTest, AStopAsksForWhatIsThere) {
    const auto session = connected();
    std::stop_source stop;
    auto rendered = in_background([&] { return session->render(small_job(), {}, stop.get_token()); });
    const auto start = master_.expect<wire::StartJob>();
    stop.request_stop();
    EXPECT_EQ(master_.expect<wire::StopJob>().job, start.job);
    master_.send(
        wire::JobDone{.job = start.job, .outcome = wire::JobOutcome::Stopped, .tiles = 1, .samples = 2});
    master_.send(tile(start.job, 0, 1, {2, 1, 1, 1}));
    const JobResult result = rendered.get();
    EXPECT_EQ(result.outcome, Outcome::Stopped);
    EXPECT_EQ(result.film->counts[0], 2u);
    EXPECT_EQ(result.film->counts[1], 0u);
}

TEST_F(SessionTest, AStopBeforeTheStartFollowsIt) {
    const auto session = connected();
    std::stop_source stop;
    stop.request_stop();
    auto rendered = in_background([&] { return session->render(small_job(), {}, stop.get_token()); });
    wire::StartJob start;
    try {
        start = master_.expect<wire::StartJob>();
    } catch (const std::bad_variant_access&) {  // a stop of nothing may come first
        start = master_.expect<wire::StartJob>();
    }
    EXPECT_EQ(master_.expect<wire::StopJob>().job, start.job);
    master_.send(wire::JobDone{.job = start.job, .outcome = wire::JobOutcome::Stopped});
    EXPECT_FALSE(rendered.get().film);
}

TEST_F(SessionTest, TilesThatDoNotFitAreAnError) {
    for (const Rect rect : {Rect{0, 0, 4, 3}, Rect{5, 3, 2, 1}, Rect{1, 1, 1, 1}}) {
        net::LoopbackHub hub;
        ScriptedMaster master(hub);
        auto connecting = in_background([&] {
            return std::make_unique<Session>(hub.client(net::Role::Editor), std::function<void()>(), blobs_,
                                             clock_, SessionSettings{});
        });
        master.greet();
        const auto session = connecting.get();
        auto rendered = in_background([&] { return session->render(small_job(), {}, {}); });
        const auto start = master.expect<wire::StartJob>();
        master.send(tile(start.job, 0, 1, rect));
        expect_error(rendered, ErrorCode::InvalidInput);
    }
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

TEST_F(SessionTest, AMasterThatLeavesEndsTheCall) {
    const auto session = connected();
    auto rendered = in_background([&] { return session->render(small_job(), {}, {}); });
    master_.expect<wire::StartJob>();
    master_.send(wire::Goodbye{"the master stops", {}});
    expect_error(rendered, ErrorCode::Unavailable);
}

TEST_F(SessionTest, AfterSilenceItComesBackAsTheSameAndTheFrameGoesOn) {
    auto connecting = connect();
    master_.greet(quick_welcome());
    const auto session = connecting.get();
    auto rendered = in_background([&] { return session->render(small_job(), {}, {}); });
    const auto start = master_.expect<wire::StartJob>();
    // Nothing is said: the next word is a greeting, over new sockets.
    const wire::Hello again = master_.greet();
    EXPECT_EQ(again.resume_token, 70u);
    EXPECT_GE(reconnects_, 1);
    master_.send(tile(start.job, 0, 1, {2, 1, 4, 3}));
    master_.send(wire::JobDone{.job = start.job, .tiles = 1, .samples = 24});
    EXPECT_EQ(rendered.get().samples, 24u);
}

TEST_F(SessionTest, AnEditUnderWayIsSentAgainAfterABreak) {
    auto connecting = connect();
    master_.greet(quick_welcome());
    const auto session = connecting.get();
    auto submitted = in_background([&] { return session->submit(material(3), {}); });
    EXPECT_EQ(master_.expect<wire::SubmitEdit>().edit.sequence, 1u);
    master_.greet();
    EXPECT_EQ(master_.expect<wire::SubmitEdit>().edit.sequence, 1u);
    master_.send(wire::EditReply{.sequence = 1, .accepted = true, .version = {1, 2}, .problems = {}});
    EXPECT_TRUE(submitted.get()->accepted);
}

TEST_F(SessionTest, AMasterThatForgotTheSessionEndsTheFrame) {
    auto connecting = connect();
    master_.greet(quick_welcome());
    const auto session = connecting.get();
    auto rendered = in_background([&] { return session->render(small_job(), {}, {}); });
    master_.expect<wire::StartJob>();
    wire::Welcome stranger = quick_welcome();
    stranger.peer_number = 8;
    master_.greet(stranger);
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
    wire::StatusReply reply{.software = "x"};
    reply.nodes.push_back({.summary = {.id = NodeId{3}, .name = "n"}, .phase = wire::NodePhase::Building});
    master_.send(reply);
    const ClusterStatus heard = status.get();
    EXPECT_EQ(heard.software, "x");
    ASSERT_EQ(heard.nodes.size(), 1u);
    EXPECT_EQ(heard.nodes[0].phase, "building");
}

}  // namespace
}  // namespace tessera::client
