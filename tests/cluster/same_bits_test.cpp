// The same bits for any number of nodes, any policy, and any faults of messages and nodes.
#include <gtest/gtest.h>

#include <array>

#include "mediator/frame/resolve.h"
#include "mediator/scene/fields.h"
#include "mediator/wire/envelope.h"
#include "tests/cluster/cluster_scene.h"
#include "tests/cluster/loopback_cluster.h"

namespace tessera::test {
namespace {

using session::Policy;
using namespace scene;
using namespace std::chrono_literals;

constexpr std::uint64_t Spp = 13;  // no power of two: several roots per tile

session::ViewRequest request_for(Policy policy, std::uint64_t seed) {
    session::ViewRequest request{.stop = {.spp = Spp}, .policy = policy, .wait_limit = 60s, .film = true};
    request.view.width = 100;
    request.view.height = 70;
    request.view.window = {0, 0, 100, 70};
    request.view.seed = seed;
    request.view.camera = view::perspective(glm::dmat4(1.0), 0.8, 100.0 / 70.0);
    request.view.channels = {frame::Channel::Radiance, frame::Channel::Albedo, frame::Channel::Depth,
                             frame::Channel::ObjectIndex};
    return request;
}

client::ViewResult render(LoopbackCluster& cluster, const session::ViewRequest& request) {
    auto blobs = std::make_shared<BlobStore>();
    const auto session = cluster.batch(blobs);
    client::ViewResult result = client::render(*session, request, {}, {});
    EXPECT_EQ(result.summary.outcome, session::Outcome::Complete) << result.summary.message;
    return result;
}

std::string hash_of(const client::ViewResult& result) {
    return to_hex(frame::film_hash(*result.film()));
}

std::string reference_hash(std::uint64_t seed, const std::string& backend = "null") {
    LoopbackCluster cluster;
    cluster.add_node(backend);
    return hash_of(render(cluster, request_for(Policy::Tiled, seed)));
}

struct Trouble {
    const char* name;
    LoopbackCluster::NodeFaults faults;
};

void PrintTo(const Trouble& trouble, std::ostream* out) {
    *out << trouble.name;
}

const std::array<Trouble, 3> Troubles{{
    {"none", {}},
    {"late, twice, out of order",
     {{.seed = 3, .duplicate = 0.05, .max_delay = 2ms},
      {.seed = 4, .duplicate = 0.2, .reorder = 0.3, .max_delay = 4ms}}},
    {"some film is lost",
     {{.seed = 5, .max_delay = 1ms}, {.seed = 6, .lose = 0.05, .reorder = 0.2, .max_delay = 2ms}}},
}};

class SameBits : public testing::TestWithParam<std::tuple<int, Policy, Trouble>> {};

TEST_P(SameBits, ForAnyClusterAndAnyFaults) {
    const auto& [nodes, policy, trouble] = GetParam();
    LoopbackCluster cluster;
    for (int i = 0; i < nodes; ++i) {
        LoopbackCluster::NodeFaults faults = trouble.faults;
        faults.control.seed += 100 * static_cast<std::uint64_t>(i);
        faults.bulk.seed += 100 * static_cast<std::uint64_t>(i);
        cluster.add_node("null", faults);
    }
    session::ViewRequest request = request_for(policy, 1);
    request.min_nodes = static_cast<std::uint32_t>(nodes);
    const client::ViewResult result = render(cluster, request);
    EXPECT_EQ(hash_of(result), reference_hash(1));
    std::uint64_t counted = result.summary.nonfinite_samples;
    for (const std::uint32_t count : result.film()->counts) counted += count;
    EXPECT_EQ(counted, 100u * 70u * Spp);
}

INSTANTIATE_TEST_SUITE_P(Clusters, SameBits,
                         testing::Combine(testing::Values(1, 2, 7),
                                          testing::Values(Policy::Tiled, Policy::Cooperative, Policy::Mixed),
                                          testing::ValuesIn(Troubles)));

// Sockets add threads and queues of their own.
class SameBitsOverZeroMQ : public testing::TestWithParam<Trouble> {};

TEST_P(SameBitsOverZeroMQ, ForAnyFaults) {
    LoopbackCluster cluster({}, Transport::ZeroMQ);
    for (std::uint64_t i = 0; i < 3; ++i) {
        LoopbackCluster::NodeFaults faults = GetParam().faults;
        faults.control.seed += 100 * i;
        faults.bulk.seed += 100 * i;
        cluster.add_node("null", faults);
    }
    session::ViewRequest request = request_for(Policy::Mixed, 1);
    request.min_nodes = 3;
    EXPECT_EQ(hash_of(render(cluster, request)), reference_hash(1));
}

INSTANTIATE_TEST_SUITE_P(Faults, SameBitsOverZeroMQ, testing::ValuesIn(Troubles));

TEST(Cluster, AnotherSeedGivesOtherBits) {
    EXPECT_NE(reference_hash(1), reference_hash(2));
}

TEST(Cluster, EmbreeGivesTheSameBitsOnOneNodeAndOnThree) {
    LoopbackCluster cluster;
    for (int i = 0; i < 3; ++i) cluster.add_node("embree");
    session::ViewRequest request = request_for(Policy::Cooperative, 1);
    request.min_nodes = 3;
    EXPECT_EQ(hash_of(render(cluster, request)), reference_hash(1, "embree"));
}

TEST(Cluster, ANodeDisconnectedWhileRenderingChangesNothing) {
    LoopbackCluster cluster;
    cluster.add_node("null", {}, 2us);
    cluster.add_node("null", {.control = {}, .bulk = {.cut_after_messages = 25}}, 2us);
    session::ViewRequest request = request_for(Policy::Mixed, 1);
    request.min_nodes = 2;
    const client::ViewResult result = render(cluster, request);
    EXPECT_EQ(hash_of(result), reference_hash(1));
    EXPECT_GT(result.summary.units.reissued, 0u)
        << "film of the cut node was lost: its units must be rendered again";
}

TEST(Cluster, ANodeThatJoinsLateGetsWork) {
    LoopbackCluster cluster;
    cluster.add_node("null", {}, 20us);
    std::jthread late([&cluster] {
        std::this_thread::sleep_for(300ms);
        cluster.add_node("null", {}, 20us);
    });
    const client::ViewResult result = render(cluster, request_for(Policy::Mixed, 1));
    late.join();
    EXPECT_EQ(hash_of(result), reference_hash(1));
    EXPECT_EQ(result.summary.nodes.size(), 2u);
}

TEST(Cluster, ReportsThatNoNodeConnected) {
    LoopbackCluster cluster;
    auto blobs = std::make_shared<BlobStore>();
    const auto session = cluster.session(blobs);
    session->join({.title = "test", .exclusive = true}, {});
    session::ViewRequest request = request_for(Policy::Mixed, 1);
    request.wait_limit = 300ms;
    EXPECT_EQ(client::render(*session, request, {}, {}).summary.outcome, session::Outcome::NoNodes);
}

TEST(Cluster, ANodeOfAnotherRenderRevisionIsRefused) {
    LoopbackCluster cluster;
    const auto peer = cluster.channel(net::Role::Node);
    const wire::ControlMessage hello = wire::Hello{
        .peer = wire::PeerKind::Node, .name = "new", .render_revision = frame::RenderRevision + 1};
    ASSERT_EQ(peer->send(net::Link::Control, net::ServerPeer, wire::encode(hello)), net::SendResult::Sent);
    const auto received = peer->receive(std::chrono::steady_clock::now() + 5s);
    const auto* message = std::get_if<net::Message>(&received);
    ASSERT_NE(message, nullptr);
    const auto answer = wire::decode_control(message->bytes);
    ASSERT_TRUE(answer && std::holds_alternative<wire::Refusal>(*answer));
    const std::string expected = "render revision " + std::to_string(frame::RenderRevision) +
                                 ", yours is of revision " + std::to_string(frame::RenderRevision + 1);
    EXPECT_NE(std::get<wire::Refusal>(*answer).reason.find(expected), std::string::npos)
        << std::get<wire::Refusal>(*answer).reason;
}

TEST(Cluster, ATimeLimitEndsTheFrameWithItsCounts) {
    LoopbackCluster cluster;
    cluster.add_node("null", {}, 2us);
    session::ViewRequest request = request_for(Policy::Mixed, 1);
    request.stop.spp = 1u << 20;
    request.stop.time_limit = 500ms;
    auto blobs = std::make_shared<BlobStore>();
    const auto session = cluster.session(blobs);
    session->join({.title = "test", .exclusive = true}, {});
    const client::ViewResult result = client::render(*session, request, {}, {});
    EXPECT_EQ(result.summary.outcome, session::Outcome::TimeUp);
    std::uint64_t counted = 0;
    for (const std::uint32_t count : result.film()->counts) counted += count;
    EXPECT_EQ(counted, result.summary.samples);
    EXPECT_GT(counted, 0u);
}

}  // namespace
}  // namespace tessera::test
