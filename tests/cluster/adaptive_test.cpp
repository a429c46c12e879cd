// Views that get samples where they need them: the same bits for any cluster and any faults.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <thread>

#include "mediator/frame/resolve.h"
#include "tests/cluster/cluster_scene.h"
#include "tests/cluster/lit_room.h"
#include "tests/cluster/loopback_cluster.h"

namespace tessera::test {
namespace {

using session::Policy;
using namespace scene;
using namespace std::chrono_literals;

session::ViewRequest adaptive_request(double noise, Policy policy = Policy::Mixed) {
    session::ViewRequest request{
        .stop = {.spp = 4096, .noise = noise}, .policy = policy, .wait_limit = 60s, .film = true};
    request.view.width = 100;
    request.view.height = 70;
    request.view.window = {0, 0, 100, 70};
    request.view.camera = view::perspective(glm::dmat4(1.0), 0.8, 100.0 / 70.0);
    request.view.channels = {frame::Channel::Radiance, frame::Channel::Albedo, frame::Channel::Depth,
                             frame::Channel::FirstHalf};
    return request;
}

client::ViewResult render_adaptive(LoopbackCluster& cluster, const session::ViewRequest& request,
                                   session::Outcome outcome = session::Outcome::Complete) {
    const auto session = cluster.batch(std::make_shared<BlobStore>());
    client::ViewResult result = client::render(*session, request, {}, {});
    EXPECT_EQ(result.summary.outcome, outcome) << result.summary.message;
    return result;
}

std::string adaptive_hash(const client::ViewResult& result) {
    return to_hex(frame::film_hash(*result.film()));
}

std::string adaptive_reference(double noise, const std::string& backend = "null") {
    LoopbackCluster cluster;
    cluster.add_node(backend);
    return adaptive_hash(render_adaptive(cluster, adaptive_request(noise, Policy::Tiled)));
}

constexpr double Noise = 0.06;

TEST(AdaptiveViews, EndAtTheNoiseThatIsAskedFor) {
    LoopbackCluster cluster;
    cluster.add_node("null");
    const client::ViewResult result = render_adaptive(cluster, adaptive_request(Noise));
    EXPECT_GT(result.summary.noise, 0.5 * Noise);
    EXPECT_LE(result.summary.noise, Noise);
    const auto [least, most] = std::ranges::minmax(result.film()->counts);
    EXPECT_GE(least, 16u);
    EXPECT_GT(most, least);
    std::uint64_t counted = 0;
    for (const std::uint32_t count : result.film()->counts) {
        EXPECT_EQ(count & (count - 1), 0u) << "a power of two";
        counted += count;
    }
    EXPECT_EQ(counted, result.summary.samples);
    const auto& units = result.summary.units;
    EXPECT_EQ(units.issued + units.reissued,
              units.merged + units.duplicate + units.cancelled + units.refused + units.lost);
}

TEST(AdaptiveViews, HaveTheSameBitsForAnyClusterAndAnyFaults) {
    const std::string expected = adaptive_reference(Noise);
    const std::array<LoopbackCluster::NodeFaults, 3> troubles{{
        {},
        {{.seed = 3, .duplicate = 0.05, .max_delay = 2ms},
         {.seed = 4, .duplicate = 0.2, .reorder = 0.3, .max_delay = 4ms}},
        {{.seed = 5, .max_delay = 1ms}, {.seed = 6, .lose = 0.05, .reorder = 0.2, .max_delay = 2ms}},
    }};
    for (const Policy policy : {Policy::Tiled, Policy::Cooperative, Policy::Mixed}) {
        for (std::size_t trouble = 0; trouble < troubles.size(); ++trouble) {
            LoopbackCluster cluster;
            for (std::uint64_t node = 0; node < 3; ++node) {
                LoopbackCluster::NodeFaults faults = troubles[trouble];
                faults.control.seed += 100 * node;
                faults.bulk.seed += 100 * node;
                cluster.add_node("null", faults);
            }
            session::ViewRequest request = adaptive_request(Noise, policy);
            request.min_nodes = 3;
            EXPECT_EQ(adaptive_hash(render_adaptive(cluster, request)), expected)
                << "policy " << static_cast<int>(policy) << ", trouble " << trouble;
        }
    }
}

// Steps that a filter of halves of the film decides.
TEST(AdaptiveViews, EndAtTheErrorOfTheirFilteredPicture) {
    constexpr double Error = 1e-4;
    const auto render_on = [&](int nodes) {
        LoopbackCluster cluster;
        for (int i = 0; i < nodes; ++i) cluster.add_node("null");
        session::ViewRequest request = adaptive_request(0.0);
        request.stop.error = Error;
        request.view.filter = "gauss:sigma=0.5";
        request.min_nodes = static_cast<std::uint32_t>(nodes);
        return render_adaptive(cluster, request);
    };
    const client::ViewResult one = render_on(1), three = render_on(3);
    EXPECT_GT(one.summary.error, 0.3 * Error);
    EXPECT_LE(one.summary.error, Error);
    EXPECT_GT(one.summary.steps, 1u);
    EXPECT_EQ(three.summary.error, one.summary.error);
    EXPECT_EQ(adaptive_hash(three), adaptive_hash(one));
}

TEST(AdaptiveViews, SurviveANodeThatDisconnects) {
    LoopbackCluster cluster;
    cluster.add_node("null", {}, 2us);
    cluster.add_node("null", {.control = {}, .bulk = {.cut_after_messages = 12}}, 2us);
    session::ViewRequest request = adaptive_request(Noise);
    request.min_nodes = 2;
    const client::ViewResult result = render_adaptive(cluster, request);
    EXPECT_EQ(adaptive_hash(result), adaptive_reference(Noise));
    EXPECT_GT(result.summary.units.reissued, 0u);
}

TEST(AdaptiveViews, HaveTheSameBitsOnEachNumberOfEmbreeNodes) {
    const std::string expected = adaptive_reference(0.1, "embree");
    LoopbackCluster cluster;
    for (int i = 0; i < 3; ++i) cluster.add_node("embree");
    session::ViewRequest request = adaptive_request(0.1);
    request.min_nodes = 3;
    EXPECT_EQ(adaptive_hash(render_adaptive(cluster, request)), expected);
}

TEST(AdaptiveViews, NeverExceedTheirMostSamples) {
    LoopbackCluster cluster;
    cluster.add_node("null");
    session::ViewRequest request = adaptive_request(1e-4);
    request.stop.spp = 100;
    const client::ViewResult result = render_adaptive(cluster, request);
    EXPECT_GT(result.summary.noise, 1e-4);
    EXPECT_TRUE(std::ranges::all_of(result.film()->counts, [](std::uint32_t n) { return n == 64; }));
    // Below the samples that a decision needs they are uniform.
    request.stop.spp = 13;
    const client::ViewResult few = render_adaptive(cluster, request);
    EXPECT_TRUE(std::ranges::all_of(few.film()->counts, [](std::uint32_t n) { return n == 13; }));
}

TEST(AdaptiveViews, EndWhenTheirTimeIsUp) {
    LoopbackCluster cluster;
    cluster.add_node("null", {}, 5us);
    session::ViewRequest request = adaptive_request(1e-4);
    request.stop.time_limit = 1s;
    const client::ViewResult result = render_adaptive(cluster, request, session::Outcome::TimeUp);
    EXPECT_GT(result.summary.samples, 100u * 70u * 16u);
    std::uint64_t counted = 0;
    for (const std::uint32_t count : result.film()->counts) counted += count;
    EXPECT_EQ(counted, result.summary.samples) << "also of blocks that were not finished";
}

TEST(AdaptiveViews, SpendTimeWhereItIsNeeded) {
    LoopbackCluster cluster;
    cluster.add_node("embree");
    const auto blobs = std::make_shared<BlobStore>();
    const auto session = cluster.member("ann", blobs);
    const LitRoom room{*session, *blobs};
    ASSERT_TRUE(session->submit(room.entries()).accepted);
    session::ViewRequest request = adaptive_request(0.0);
    request.view.width = request.view.window.width = 50;  // enough samples, also on a busy machine
    request.view.height = request.view.window.height = 35;
    request.view.camera.world_from_camera[3][2] = 6.0;  // darkness around the room
    request.stop = {.spp = session::MaxSamplesPerPixel, .time_limit = 2s};
    const auto spread = [&] {
        const client::ViewResult result = client::render(*session, request, {}, {});
        EXPECT_EQ(result.summary.outcome, session::Outcome::TimeUp) << result.summary.message;
        EXPECT_GT(result.summary.samples, 50u * 35u * 32u);
        const auto [least, most] = std::ranges::minmax(result.film()->counts);
        EXPECT_GE(least, 16u);
        return double(most) / double(least);
    };
    EXPECT_GT(spread(), 2.0);
    request.stop.uniform = true;
    EXPECT_LE(spread(), 2.0) << "the round that was cut";
}

// No pixel is known to need them: they are uniform, until the time is up.
TEST(AdaptiveViews, SpendTheirTimeInTheDark) {
    LoopbackCluster cluster;
    cluster.add_node("embree");
    session::ViewRequest request = adaptive_request(0.0);
    request.stop = {.spp = session::MaxSamplesPerPixel, .time_limit = 500ms};
    const client::ViewResult result = render_adaptive(cluster, request, session::Outcome::TimeUp);
    EXPECT_GT(result.summary.samples, 100u * 70u * 32u);
    // With an end to their samples they end there.
    request.stop = {.spp = 100, .time_limit = 60s};
    const client::ViewResult whole = render_adaptive(cluster, request);
    EXPECT_EQ(whole.summary.samples, 100u * 70u * 64u);
}

// A filter whose channels the film has is changed as usual; further channels would need another film.
TEST(AdaptiveViews, GetNoMoreChannels) {
    LoopbackCluster cluster;
    cluster.add_node("null", {}, 5us);
    const auto session = cluster.batch(std::make_shared<BlobStore>());
    const auto other = cluster.session(std::make_shared<BlobStore>());
    session::ViewRequest request = adaptive_request(Noise);
    request.view.channels = {frame::Channel::Radiance};
    request.view.filter = "none";
    request.picture = session::PictureEncoding::Planes;
    std::string answer, refusal;
    const auto meddle = [&](const session::ViewProgress& progress) {
        if (progress.phase != session::Phase::Rendering || progress.samples == 0 || !answer.empty()) return;
        answer = other->set_filter("", "gauss");
        try {
            (void)other->set_filter("", "bilateral");
        } catch (const Error& error) {
            refusal = error.what();
        }
    };
    const client::ViewResult result = client::render(*session, request, meddle, {});
    EXPECT_EQ(result.summary.outcome, session::Outcome::Complete) << result.summary.message;
    EXPECT_NE(answer.find("whole frame"), std::string::npos) << answer;
    EXPECT_NE(refusal.find("start it with the filter"), std::string::npos) << refusal;
    EXPECT_EQ(result.summary.picture.filter, "gauss");
}

// The film has a channel of `nfor`, but not that of each half.
TEST(AdaptiveViews, OfAnErrorGetNoFilterWhoseErrorIsUnknown) {
    LoopbackCluster cluster;
    cluster.add_node("null", {}, 5us);
    const auto session = cluster.batch(std::make_shared<BlobStore>());
    const auto other = cluster.session(std::make_shared<BlobStore>());
    session::ViewRequest request = adaptive_request(0.0);
    request.stop.error = 1e-3;
    request.view.channels.insert(frame::Channel::Normal);
    request.view.filter = "gauss:sigma=0.5";
    request.picture = session::PictureEncoding::Planes;
    std::string answer, refusal;
    const auto meddle = [&](const session::ViewProgress& progress) {
        if (progress.phase != session::Phase::Rendering || progress.samples == 0 || !answer.empty()) return;
        try {
            (void)other->set_filter("", "nfor");
        } catch (const Error& error) {
            refusal = error.what();
        }
        answer = other->set_filter("", "gauss:sigma=0.6");
    };
    const client::ViewResult result = client::render(*session, request, meddle, {});
    EXPECT_EQ(result.summary.outcome, session::Outcome::Complete) << result.summary.message;
    EXPECT_NE(refusal.find("cannot be estimated"), std::string::npos) << refusal;
    EXPECT_EQ(result.summary.picture.filter, "gauss:sigma=0.6");
    EXPECT_GT(result.summary.error, 0.0);
}

// A job of noise or error, with a master that keeps its sessions in a folder.
struct AdaptiveJobs : testing::Test {
    std::filesystem::path folder =
        std::filesystem::temp_directory_path() / ("tessera-adaptive-jobs-" + std::to_string(::getpid()));
    std::unique_ptr<LoopbackCluster> cluster;
    double noise = Noise, error = 0.0;
    AdaptiveJobs() { std::filesystem::remove_all(folder); }
    ~AdaptiveJobs() override {
        cluster.reset();
        std::filesystem::remove_all(folder);
    }

    void start(Duration cost) {
        cluster.reset();
        cluster = std::make_unique<LoopbackCluster>(
            [this](master::MasterSettings& settings) { settings.session_folder = folder; });
        cluster->add_node("null", {}, cost);
    }
    void submit() {
        session::ViewRequest request = adaptive_request(noise);
        request.stop.error = error;
        if (error > 0.0) request.view.filter = "gauss:sigma=0.5";
        request.name = "night";
        request.film = false;
        request.frames = session::Frames::Last;
        request.picture = session::PictureEncoding::Planes;
        request.detached = true;
        cluster->batch(std::make_shared<BlobStore>())->request_view(1, request);
    }
    // Its status once `is_reached`.
    session::JobStatus wait(const std::function<bool(const session::JobStatus&)>& is_reached) {
        const auto session = cluster->session(std::make_shared<BlobStore>());
        const auto deadline = std::chrono::steady_clock::now() + 60s;
        while (std::chrono::steady_clock::now() < deadline) {
            for (const session::JobStatus& job : session->jobs()) {
                if (is_reached(job)) return job;
            }
            std::this_thread::sleep_for(5ms);
        }
        ADD_FAILURE() << "the job does not get so far";
        return {};
    }
    session::JobStatus wait_for_end() {
        return wait([](const session::JobStatus& job) { return job.has_ended; });
    }
    client::ViewResult fetch() {
        const auto session = cluster->session(std::make_shared<BlobStore>());
        client::ViewResult result = session->fetch_job({.name = "night"});
        session->cancel_job({.name = "night"});
        return result;
    }
};

TEST_F(AdaptiveJobs, GoOnAfterMasterRestartsWithTheBitsOfOneRun) {
    start({});
    submit();
    const session::ViewSummary expected = wait_for_end().summary;
    const client::ViewResult whole = fetch();
    ASSERT_GT(expected.max_samples, 64u) << "several steps";
    // In the first samples of all pixels, and within steps.
    for (const std::vector<double>& restarts : {std::vector{0.1}, {0.5}, {0.4, 0.6, 0.8}}) {
        start(5us);
        submit();
        for (const double part : restarts) {
            const auto samples = static_cast<std::uint64_t>(part * double(expected.samples));
            (void)wait([&](const session::JobStatus& job) { return job.progress.samples >= samples; });
            start(5us);
        }
        const session::ViewSummary summary = wait_for_end().summary;
        EXPECT_EQ(summary.outcome, session::Outcome::Complete) << summary.message;
        EXPECT_EQ(summary.samples, expected.samples);
        EXPECT_EQ(summary.noise, expected.noise);
        EXPECT_EQ(fetch().frame.picture, whole.frame.picture) << "from " << restarts.front() << " on";
        std::uint64_t later = 0;
        for (const session::NodeSummary& node : summary.nodes) later += node.samples;
        EXPECT_LT(double(later), (1.15 - restarts.back()) * double(expected.samples)) << "the film was kept";
    }
}

TEST_F(AdaptiveJobs, OfAnErrorGoOnAfterAMasterRestartsWithTheBitsOfOneRun) {
    noise = 0.0;
    error = 1e-3;
    start({});
    submit();
    const session::ViewSummary expected = wait_for_end().summary;
    const client::ViewResult whole = fetch();
    ASSERT_GT(expected.steps, 1u);
    start(5us);
    submit();
    (void)wait(
        [&](const session::JobStatus& job) { return job.progress.samples >= expected.samples * 6 / 10; });
    start(5us);
    const session::ViewSummary summary = wait_for_end().summary;
    EXPECT_EQ(summary.samples, expected.samples);
    EXPECT_EQ(summary.error, expected.error);
    EXPECT_EQ(fetch().frame.picture, whole.frame.picture);
}

}  // namespace
}  // namespace tessera::test
