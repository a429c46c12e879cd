// Views of a session: tiles in any order, stops, refusals, and lost masters.
#include <gtest/gtest.h>

#include <algorithm>

#include "client/frame_collector.h"
#include "client/render.h"
#include "tests/client/session_fixture.h"

namespace tessera::client {
namespace {

using frame::Channel;
using std::chrono::milliseconds;

class SessionViewsTest : public WithScriptedMaster {
  protected:
    void submit_an_edit(Session& session) {
        auto submitted = in_background([&] { return session.submit(material(3)); });
        (void)master_.expect<wire::SubmitEdit>();
        master_.send(wire::EditReply{.sequence = 1, .result = {.accepted = true, .version = {1, 2}}});
        EXPECT_TRUE(submitted.get().accepted);
    }
};

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

// A tile whose values encode their pixel.
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

TEST_F(SessionViewsTest, AssemblesTilesInAnyOrderAlsoBeforeTheSummary) {
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

// More than the link can queue.
TEST_F(SessionViewsTest, NoTileOfABurstIsLost) {
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

TEST_F(SessionViewsTest, StopRequestsTheSamplesMergedSoFar) {
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

TEST_F(SessionViewsTest, StopBeforeTheRequestIsSentAfterIt) {
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

TEST_F(SessionViewsTest, RefusedViewIsAnError) {
    const auto session = joined();
    auto rendered = in_background([&] { return render(*session, small_view(), {}, {}); });
    const auto request = master_.expect<wire::RequestView>();
    master_.send(wire::RequestDone{request.request, false, "no such filter"});
    expect_error(rendered, ErrorCode::Refused);
}

TEST_F(SessionViewsTest, WhatTheMastersMachineLacksIsUnavailable) {
    const auto session = joined();
    auto rendered = in_background([&] { return render(*session, small_view(), {}, {}); });
    const auto request = master_.expect<wire::RequestView>();
    master_.send(wire::RequestDone{request.request, false, "no library", true});
    expect_error(rendered, ErrorCode::Unavailable);
}

// Outside of the window, duplicate position, too few pixels, count differs from the header.
TEST_F(SessionViewsTest, InconsistentTilesAreAnError) {
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

// With a gap, twice the same, of another channel set, outside of the window.
TEST_F(SessionViewsTest, InconsistentBlocksAreAnError) {
    const auto block = [](std::uint32_t left, std::uint64_t first, const Rect& rect = {2, 1, 4, 3},
                          const frame::ChannelSet& channels = {frame::Channel::Depth}) {
        frame::FilmTile film(rect, {first, 1}, channels);
        std::ranges::fill(film.counts, 2u);
        return wire::FilmBlock{.frame = FrameNumber, .count = 1, .left = left, .film = film};
    };
    const std::vector<std::vector<wire::FilmBlock>> attacks{
        {block(2, 0), block(0, 2)},
        {block(1, 0), block(0, 0)},
        {block(1, 0), block(0, 2, {2, 1, 4, 3}, {frame::Channel::Alpha})},
        {block(0, 0, {3, 1, 4, 3})},
        {block(1, 0), block(0, 2, {2, 1, 3, 3})},
    };
    for (const auto& blocks : attacks) {
        FrameCollector collector;
        collector.begin(header({.wanted = small_view()}, 1));
        bool is_refused = false;
        for (wire::FilmBlock part : blocks) is_refused = is_refused || !collector.add(std::move(part));
        EXPECT_TRUE(is_refused) << blocks.size();
        EXPECT_FALSE(collector.take());
    }
    FrameCollector collector;
    collector.begin(header({.wanted = small_view()}, 1));
    EXPECT_TRUE(collector.add(block(1, 0)));
    EXPECT_TRUE(collector.add(block(0, 2)));
    const auto frame = collector.take();
    ASSERT_TRUE(frame && frame->film_state);
    EXPECT_EQ(frame->film_state->blocks.size(), 1u) << "siblings are merged";
    EXPECT_EQ(frame->film->counts.front(), 4u);
}

// A header with impossible sizes is rejected; memory is allocated for received data only.
TEST_F(SessionViewsTest, WrongHeaderAllocatesNoMemory) {
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

TEST_F(SessionViewsTest, MasterThatStopsEndsTheCall) {
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

TEST_F(SessionViewsTest, AfterATimeoutItResumesTheSessionAndTheFrameContinues) {
    std::vector<bool> away;
    const auto session = joined({.on_away = [&](bool is_away) { away.push_back(is_away); }}, quick_welcome());
    auto rendered = in_background([&] { return render(*session, small_view(), {}, {}); });
    (void)view_requested();
    // No message: the next one is a hello, over new sockets.
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

// It was restarted with its journal: the scene is restored, and the view is requested again.
TEST_F(SessionViewsTest, RestartedMasterWithTheSceneContinuesTheFrame) {
    const auto session = joined({}, quick_welcome());
    submit_an_edit(*session);
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

TEST_F(SessionViewsTest, MasterThatLostTheSceneEndsTheFrame) {
    const auto session = joined({}, quick_welcome());
    submit_an_edit(*session);
    auto rendered = in_background([&] { return render(*session, small_view(), {}, {}); });
    (void)view_requested();
    wire::Welcome stranger = quick_welcome();
    stranger.peer_number = 8;
    master_.greet(stranger);
    EXPECT_TRUE(master_.expect<wire::JoinScene>().exclusive);
    master_.send(Scene);
    expect_error(rendered, ErrorCode::Unavailable);
}

}  // namespace
}  // namespace tessera::client
