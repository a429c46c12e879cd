// Jobs: views that continue when their client has left, and whose picture is stored.
#include <gtest/gtest.h>

#include <thread>

#include "tests/cluster/cluster_scene.h"
#include "tests/cluster/loopback_cluster.h"

namespace tessera::test {
namespace {

using namespace std::chrono_literals;

session::ViewRequest job_request(const std::string& name, std::uint64_t spp = 8) {
    session::ViewRequest request{.name = name,
                                 .stop = {.spp = spp},
                                 .frames = session::Frames::Last,
                                 .picture = session::PictureEncoding::Planes,
                                 .detached = true};
    request.view.width = 90;
    request.view.height = 60;
    request.view.window = {0, 0, 90, 60};
    request.view.camera = view::perspective(glm::dmat4(1.0), 0.8, 1.5);
    request.view.channels = {frame::Channel::Radiance};
    return request;
}

struct Jobs : testing::Test {
    LoopbackCluster cluster;
    std::shared_ptr<scene::BlobStore> blobs = std::make_shared<scene::BlobStore>();

    void submit(const session::ViewRequest& request) { cluster.batch(blobs)->request_view(1, request); }
    static session::JobStatus ended(client::Session& session, const std::string& name) {
        const auto deadline = std::chrono::steady_clock::now() + 60s;
        while (std::chrono::steady_clock::now() < deadline) {
            for (const session::JobStatus& job : session.jobs()) {
                if (job.job.name == name && job.has_ended) return job;
            }
            std::this_thread::sleep_for(10ms);
        }
        ADD_FAILURE() << "job " << name << " does not end";
        return {};
    }
};

TEST_F(Jobs, ContinueWithoutTheirClientAndGiveTheSamePicture) {
    cluster.add_node("null", {}, 2us);
    submit(job_request("night"));
    const auto later = cluster.session(blobs);
    const session::JobStatus job = ended(*later, "night");
    EXPECT_EQ(job.scene, "test");
    EXPECT_EQ(job.summary.outcome, session::Outcome::Complete);
    EXPECT_EQ(job.summary.samples, 90u * 60u * 8u);
    const client::ViewResult fetched = later->fetch_job({.name = "night"});
    session::ViewRequest waited = job_request("");
    waited.detached = false;
    const client::ViewResult expected = client::render(*cluster.batch(blobs), waited, {}, {});
    EXPECT_EQ(fetched.frame.picture, expected.frame.picture);
    EXPECT_EQ(fetched.frame.width, 90u);
    EXPECT_EQ(fetched.summary.min_samples, 8u);
    EXPECT_EQ(later->fetch_job({.name = "night"}).frame.picture, expected.frame.picture) << "repeatable";
    later->cancel_job({.name = "night"});
    EXPECT_TRUE(later->jobs().empty());
    EXPECT_THROW((void)later->fetch_job({.name = "night"}), Error);
}

TEST_F(Jobs, KeepTheSceneOpenUntilTheyHaveEnded) {
    cluster.add_node("null", {}, 20us);
    submit(job_request("slow", 64));
    const auto other = cluster.session(blobs);
    const auto busy = other->join({.exclusive = true, .when_busy = client::WhenBusy::GiveUp}, {});
    EXPECT_TRUE(std::holds_alternative<client::Busy>(busy));
    ASSERT_EQ(other->jobs().size(), 1u);
    EXPECT_FALSE(other->jobs()[0].has_ended);
    EXPECT_THROW((void)other->fetch_job({.name = "slow"}), Error) << "it is still being rendered";
    other->cancel_job({.name = "slow"});
    EXPECT_TRUE(other->jobs().empty());
    const auto joined = other->join({.exclusive = true}, {});
    EXPECT_TRUE(std::holds_alternative<client::Joined>(joined)) << "the scene went with its last job";
}

TEST_F(Jobs, AreVisibleToTheirUserAndToOperators) {
    cluster.add_node("null");
    submit(job_request("mine"));
    const auto editor = cluster.session(blobs);
    (void)ended(*editor, "mine");
    const std::string user = editor->jobs().at(0).job.user;
    const auto viewer = cluster.session(blobs, net::Role::Viewer, "viewer");
    EXPECT_TRUE(viewer->jobs().empty());
    EXPECT_THROW((void)viewer->fetch_job({.user = user, .name = "mine"}), Error);
    EXPECT_THROW(viewer->cancel_job({.user = user, .name = "mine"}), Error);
    const auto stranger = cluster.session(blobs, net::Role::Editor, "stranger");
    EXPECT_TRUE(stranger->jobs().empty());
    EXPECT_THROW(stranger->cancel_job({.user = user, .name = "mine"}), Error);
    EXPECT_THROW((void)stranger->fetch_job({.name = "mine"}), Error);
    const auto operating = cluster.session(blobs, net::Role::Operator, "operator");
    ASSERT_EQ(operating->jobs().size(), 1u);
    EXPECT_TRUE(operating->fetch_job({.user = user, .name = "mine"}).has_picture());
    operating->cancel_job({.user = user, .name = "mine"});
    EXPECT_TRUE(editor->jobs().empty());
}

TEST_F(Jobs, InvalidJobsAreRefusedWithAReason) {
    cluster.add_node("null");
    const auto session = cluster.batch(blobs);
    const auto refusal = [&](auto change) {
        session::ViewRequest request = job_request("odd");
        change(request);
        try {
            session->request_view(1, request);
        } catch (const Error& error) {
            return std::string(error.what());
        }
        return std::string("it was taken");
    };
    EXPECT_NE(refusal([](auto& r) { r.name.clear(); }).find("name"), std::string::npos);
    EXPECT_NE(refusal([](auto& r) { r.film = true; }).find("film"), std::string::npos);
    EXPECT_NE(refusal([](auto& r) { r.frames = session::Frames::All; }).find("last"), std::string::npos);
    EXPECT_NE(refusal([](auto& r) { r.picture = session::PictureEncoding::None; }).find("picture"),
              std::string::npos);
    session->request_view(1, job_request("twice"));
    (void)ended(*session, "twice");
    EXPECT_NE(refusal([](auto& r) { r.name = "twice"; }).find("is stored"), std::string::npos);
}

// A connected client may wait for its result.
TEST_F(Jobs, AConnectedClientGetsThePictureTooAndAStopEndsTheJob) {
    cluster.add_node("null", {}, 5us);
    const auto session = cluster.batch(blobs);
    session->request_view(1, job_request("both", 1u << 20));
    std::stop_source stop;
    std::jthread stopping([&] {
        std::this_thread::sleep_for(300ms);
        stop.request_stop();
    });
    const client::ViewResult result = session->wait_for_end(1, {}, stop.get_token());
    EXPECT_EQ(result.summary.outcome, session::Outcome::Stopped);
    EXPECT_TRUE(result.has_picture());
    EXPECT_EQ(ended(*session, "both").summary.outcome, session::Outcome::Stopped);
    EXPECT_EQ(session->fetch_job({.name = "both"}).frame.picture, result.frame.picture);
}

}  // namespace
}  // namespace tessera::test
