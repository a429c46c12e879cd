// Views that go on with the film of an earlier one: the bits of one that was never interrupted.
#include <gtest/gtest.h>

#include <algorithm>

#include "mediator/frame/resolve.h"
#include "tests/cluster/cluster_scene.h"
#include "tests/cluster/loopback_cluster.h"
#include "tests/cluster/raw_peer.h"

namespace tessera::test {
namespace {

using namespace std::chrono_literals;

session::ViewRequest continued_request(std::uint64_t spp, double noise = 0.0) {
    session::ViewRequest request{
        .stop = {.spp = spp, .noise = noise}, .wait_limit = 60s, .film = true, .film_state = true};
    request.view.width = 100;
    request.view.height = 70;
    request.view.window = {0, 0, 100, 70};
    request.view.camera = view::perspective(glm::dmat4(1.0), 0.8, 100.0 / 70.0);
    request.view.channels = {frame::Channel::Radiance, frame::Channel::Depth, frame::Channel::BlockVariance};
    return request;
}

std::string continued_hash(const client::ViewResult& result) {
    return to_hex(frame::film_hash(*result.film()));
}

// Each call is a client and a scene of its own.
client::ViewResult render_from(LoopbackCluster& cluster, const session::ViewRequest& request,
                               const client::EarlierFilm* earlier = nullptr,
                               const std::function<void(const session::ViewProgress&)>& on_progress = {},
                               std::stop_token stop = {}) {
    const auto session = cluster.batch(std::make_shared<scene::BlobStore>());
    return client::render(*session, request, on_progress, stop, client::Session::AfterEnd::Close, earlier);
}

// As it is stopped once `is_enough`.
client::ViewResult render_partly(LoopbackCluster& cluster, const session::ViewRequest& request,
                                 const std::function<bool(const session::ViewProgress&)>& is_enough) {
    std::stop_source stop;
    return render_from(
        cluster, request, nullptr,
        [&](const session::ViewProgress& progress) {
            if (is_enough(progress)) stop.request_stop();
        },
        stop.get_token());
}

client::EarlierFilm saved_film(const client::ViewResult& result) {
    client::EarlierFilm film{.film = *result.frame.film_state,
                             .scene_hash = result.summary.scene_hash,
                             .render_revision = frame::RenderRevision,
                             .kind = result.summary.nodes.front().kind};
    film.film.steps = result.summary.steps;
    return film;
}

struct ContinuedFilms : testing::Test {
    LoopbackCluster cluster;
    ContinuedFilms() { cluster.add_node("null"); }

    std::string refusal(const session::ViewRequest& request, const client::EarlierFilm& film) {
        try {
            render_from(cluster, request, &film);
            return "it was not refused";
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::Refused);
            return error.what();
        }
    }
};

TEST_F(ContinuedFilms, HaveTheBitsOfOneRun) {
    const client::ViewResult whole = render_from(cluster, continued_request(128));
    client::ViewResult part = render_from(cluster, continued_request(48));
    EXPECT_GT(part.frame.film_state->blocks.size(), 1u);
    for (const std::uint64_t spp : {50, 64, 128}) {
        const client::EarlierFilm film = saved_film(part);
        const std::uint64_t before = part.summary.samples;
        part = render_from(cluster, continued_request(spp), &film);
        EXPECT_EQ(part.summary.samples_before, before);
        EXPECT_EQ(part.summary.samples, spp * 7000);
        std::uint64_t rendered = 0;
        for (const session::NodeSummary& node : part.summary.nodes) rendered += node.samples;
        EXPECT_EQ(rendered, part.summary.samples - before) << "no sample is taken again";
    }
    EXPECT_EQ(continued_hash(part), continued_hash(whole));
}

TEST_F(ContinuedFilms, AreTheSameFilmWithAndWithoutTheirBlocks) {
    session::ViewRequest merged = continued_request(48);
    merged.film_state = false;
    const client::ViewResult a = render_from(cluster, merged),
                             b = render_from(cluster, continued_request(48));
    EXPECT_FALSE(a.frame.film_state);
    EXPECT_EQ(continued_hash(a), continued_hash(b));
    EXPECT_EQ(a.film()->nonfinite_samples, b.film()->nonfinite_samples);
}

TEST_F(ContinuedFilms, GoOnAfterAnInterrupt) {
    LoopbackCluster slow;
    slow.add_node("null", {}, 20us);
    slow.add_node("null", {}, 20us);
    const client::ViewResult part = render_partly(
        slow, continued_request(64), [](const auto& progress) { return progress.samples > 7000 * 5; });
    ASSERT_EQ(part.summary.outcome, session::Outcome::Stopped);
    ASSERT_LT(part.summary.samples, 7000u * 64);
    const client::EarlierFilm film = saved_film(part);
    EXPECT_EQ(continued_hash(render_from(cluster, continued_request(64), &film)),
              continued_hash(render_from(cluster, continued_request(64))));
}

TEST_F(ContinuedFilms, WithStepsHaveTheBitsOfOneRun) {
    constexpr double Noise = 0.06;
    const std::string expected = continued_hash(render_from(cluster, continued_request(4096, Noise)));
    LoopbackCluster slow;
    slow.add_node("null", {}, 10us);
    slow.add_node("null", {}, 10us);
    bool was_in_a_step = false;
    for (const std::uint64_t samples : {7000 * 5, 7000 * 17, 7000 * 24, 7000 * 40}) {
        const client::ViewResult part =
            render_partly(slow, continued_request(4096, Noise),
                          [&](const auto& progress) { return progress.samples > samples; });
        const client::EarlierFilm film = saved_film(part);
        was_in_a_step = was_in_a_step || !film.film.wanted.empty();
        const client::ViewResult whole = render_from(cluster, continued_request(4096, Noise), &film);
        EXPECT_EQ(whole.summary.outcome, session::Outcome::Complete);
        EXPECT_EQ(continued_hash(whole), expected) << samples;
    }
    EXPECT_TRUE(was_in_a_step);
}

TEST_F(ContinuedFilms, OfEqualSamplesGoOnToANoise) {
    const client::EarlierFilm film = saved_film(render_from(cluster, continued_request(48)));
    const client::ViewResult result = render_from(cluster, continued_request(4096, 0.03), &film);
    EXPECT_EQ(result.summary.outcome, session::Outcome::Complete);
    EXPECT_GT(result.summary.noise, 0.0);
    EXPECT_LE(result.summary.noise, 0.03);
    EXPECT_GE(*std::ranges::min_element(result.film()->counts), 64u);
    const client::EarlierFilm further = saved_film(result);
    const client::ViewResult finer = render_from(cluster, continued_request(4096, 0.02), &further);
    EXPECT_LE(finer.summary.noise, 0.02);
    EXPECT_GT(finer.summary.samples, result.summary.samples);
}

TEST_F(ContinuedFilms, OfWhatTheViewIsNotAreRefused) {
    const client::EarlierFilm good = saved_film(render_from(cluster, continued_request(16)));
    client::EarlierFilm film = good;
    film.scene_hash.low ^= 1;
    EXPECT_NE(refusal(continued_request(32), film).find("another scene"), std::string::npos);
    film = good;
    film.render_revision += 1;
    EXPECT_NE(refusal(continued_request(32), film).find("render revision"), std::string::npos);
    EXPECT_NE(refusal(continued_request(8), good).find("more samples"), std::string::npos);
    session::ViewRequest other = continued_request(32);
    other.tile = 16;
    EXPECT_NE(refusal(other, good).find("other tiles"), std::string::npos);
    other = continued_request(32);
    other.view.channels.insert(frame::Channel::Albedo);
    EXPECT_NE(refusal(other, good).find("albedo"), std::string::npos);
    film = good;
    film.film.steps = 2;
    EXPECT_NE(refusal(continued_request(32), film).find("different numbers"), std::string::npos);
    film = good;
    film.film.blocks[0].planes[0] = std::nanf("");
    EXPECT_NE(refusal(continued_request(32), film).find("malformed"), std::string::npos);
    // The cluster is as good as before.
    EXPECT_EQ(continued_hash(render_from(cluster, continued_request(32), &good)),
              continued_hash(render_from(cluster, continued_request(32))));
}

// A peer with a scene, and its request for a view with film that the master has yet to fetch.
struct FilmOfAPeer : testing::Test {
    LoopbackCluster cluster;
    wire::RequestView request{
        .request = 7, .number = 3, .wanted = continued_request(32), .earlier = wire::EarlierFilm{}};

    FilmOfAPeer() {
        request.earlier->film = {blake2b(std::as_bytes(std::span("film"))), 1000};
        request.earlier->render_revision = frame::RenderRevision;
        request.wanted.frames = session::Frames::Last;
    }
    RawPeer joined(net::Role role) {
        RawPeer peer(cluster.channel(role, "eve"));
        EXPECT_TRUE(peer.connect("eve"));
        peer.send(wire::JoinScene{.title = "room", .name = "eve", .key = 5});
        EXPECT_TRUE(peer.wait_for<wire::SceneJoined>());
        return peer;
    }
    static void expect_refusal(RawPeer& peer, const std::string& reason, std::size_t n = 0) {
        ASSERT_TRUE(peer.wait_for<wire::RequestDone>(n)) << reason;
        const auto* done = peer.received<wire::RequestDone>(n);
        EXPECT_FALSE(done->accepted);
        EXPECT_EQ(done->request, 7u);
        EXPECT_NE(done->text.find(reason), std::string::npos) << done->text;
    }
};

TEST_F(FilmOfAPeer, ThatItDoesNotSendIsAnswered) {
    RawPeer peer = joined(net::Role::Editor);
    peer.send(request);
    ASSERT_TRUE(peer.wait_for<wire::BlobRequest>());
    // Again, as after a lost link: the request, and the view without its number.
    peer.send(request);
    wire::RequestView view = request;
    view.request = 0;
    peer.send(view);
    peer.send(wire::BlobAbsent{request.earlier->film.hash});
    expect_refusal(peer, "does not have");
    peer.send(request);
    ASSERT_TRUE(peer.wait_for<wire::BlobRequest>(1));
    peer.send(wire::EndView{.number = 3});
    expect_refusal(peer, "was ended", 1);
    peer.send(request);
    wire::RequestView other = request;
    other.request = 8;
    other.earlier.reset();
    peer.send(other);
    ASSERT_TRUE(peer.wait_for<wire::RequestDone>(2));
    EXPECT_EQ(peer.received<wire::RequestDone>(2)->request, 8u);
    EXPECT_TRUE(peer.received<wire::RequestDone>(2)->accepted) << "views without film wait for nothing";
}

TEST_F(FilmOfAPeer, IsNotTakenFromViewers) {
    const auto ann = cluster.member("ann", std::make_shared<scene::BlobStore>());
    RawPeer peer = joined(net::Role::Viewer);
    peer.send(request);
    expect_refusal(peer, "a viewer");
}

TEST_F(FilmOfAPeer, MayNotBeLargerThanTheMastersMemory) {
    RawPeer peer = joined(net::Role::Editor);
    request.earlier->film.byte_size = std::uint64_t{1} << 45;
    peer.send(request);
    ASSERT_TRUE(peer.wait_for<wire::RequestDone>());
    EXPECT_FALSE(peer.received<wire::RequestDone>()->accepted);
    EXPECT_EQ(peer.received<wire::BlobRequest>(), nullptr);
}

}  // namespace
}  // namespace tessera::test
