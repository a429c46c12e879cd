// A display of a running cluster: opened, adjusted, followed by a tracked head and closed by the commands.
#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/socket.h>
#include <unistd.h>

#include <fstream>

#include "client/display_file/display_file.h"
#include "client/import/import.h"
#include "client/session.h"
#include "mediator/display/frustum.h"
#include "tests/process/real_cluster.h"
#include "tests/support/folders.h"

namespace tessera::test {
namespace {

using namespace std::chrono_literals;

constexpr std::chrono::milliseconds DisplayPatience = 2min;

constexpr const char* Wall = R"([display]
name = "wall"
spp = 4
rate = 240
[head]
eye_separation = 0.064
[[layer]]
name = "solid"
[[layer]]
name = "menu"
[[output]]
name = "left-half"
size = [64, 48]
stereo = "side-by-side"
screen = { lower_left = [-2, -1, -2], lower_right = [0, -1, -2], upper_left = [-2, 1, -2] }
)";

struct Result {
    int code = -1;
    std::string out, err;
};

struct DisplayProcess : testing::Test {
    RealCluster cluster;
    SteadyClock clock;
    std::shared_ptr<scene::BlobStore> blobs = std::make_shared<scene::BlobStore>();
    std::unique_ptr<client::Session> ann, output_client;
    std::string file = cluster.folder() / "wall.toml";
    std::vector<client::OutputFrame> frames;
    bool pattern = false;
    int calls = 0;

    DisplayProcess() { std::ofstream(file) << Wall; }

    std::vector<std::string> with_cluster(std::vector<std::string> words) const {
        words.insert(words.end(), {"--master", cluster.endpoint(), "--keys", cluster.keys()});
        return words;
    }
    Result display(std::vector<std::string> words) {
        words.insert(words.begin(), "display");
        ChildProcess process(cluster.folder().path(), "display" + std::to_string(calls++), "tessera",
                             with_cluster(std::move(words)));
        const auto code = process.wait(DisplayPatience);
        return {code.value_or(-1), process.out(), process.err()};
    }
    std::unique_ptr<client::Session> member(const std::string& name) {
        auto session = client::connect({cluster.endpoint(), cluster.keys()}, blobs, clock, {.name = name});
        session->join({.title = "room"}, {});
        return session;
    }
    void load_scene() {
        ann = member("ann");
        const auto imported = import::import_scene(scene_file("still.glb"), {.first_id = ann->new_id()});
        ASSERT_TRUE(imported);
        for (const scene::BlobPtr& blob : imported->blobs) blobs->insert(blob);
        ASSERT_TRUE(ann->submit(import::entries(*imported, import::RootEntry::Update)).accepted);
    }
    // Acknowledges frames of the output until `done` returns true.
    template <class Done>
    void until(const Done& done) {
        const auto deadline = std::chrono::steady_clock::now() + DisplayPatience;
        while (!done()) {
            ASSERT_LT(std::chrono::steady_clock::now(), deadline)
                << "it did not happen: " << cluster.master().err();
            auto event = output_client->next_output_event(std::chrono::steady_clock::now() + 10ms, {});
            if (!event) continue;
            if (const auto* opened = std::get_if<session::OutputOpened>(&*event)) {
                pattern = opened->pattern;
                output_client->output_ready(0);
            }
            if (auto* frame = std::get_if<client::OutputFrame>(&*event)) {
                output_client->output_ready(frame->number);
                frames.push_back(std::move(*frame));
            }
        }
    }
    // A cluster that shows the wall's output.
    void show() {
        ASSERT_NO_FATAL_FAILURE(load_scene());
        ASSERT_EQ(display({"open", file}).code, 0);
        output_client = member("output_client");
        output_client->join_output("left-half");
        until([&] { return !frames.empty(); });
    }
    // Whether the latest frame is seen by both eyes of this head.
    bool is_seen_from(const display::Head& head, double separation) const {
        scene::BlobStore unused;
        const auto wall = display_file::read_display(file, unused).display;
        const auto& pictures = frames.back().pictures;
        for (std::size_t i = 0; i < 2; ++i) {
            const view::CameraPose wanted =
                display::frustum(wall.outputs[0].plane, head, pictures.at(i).eye, separation, 0.0);
            const view::CameraPose& camera = pictures[i].camera;
            const glm::dvec4 way = camera.world_from_camera[3] - wanted.world_from_camera[3];
            if (glm::length(way) > 1e-12 || std::abs(camera.left - wanted.left) > 1e-12 ||
                std::abs(camera.right - wanted.right) > 1e-12 || std::abs(camera.top - wanted.top) > 1e-12)
                return false;
        }
        return true;
    }
};

void send(int port, const std::string& packet) {
    const int socket = ::socket(AF_INET, SOCK_DGRAM, 0);
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(static_cast<std::uint16_t>(port));
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(
        ::sendto(socket, packet.data(), packet.size(), 0, reinterpret_cast<const sockaddr*>(&to), sizeof to),
        static_cast<ssize_t>(packet.size()));
    ::close(socket);
}

void expect_says(const std::string& text, const std::string& part) {
    EXPECT_NE(text.find(part), std::string::npos) << "'" << part << "' is not in: " << text;
}

TEST_F(DisplayProcess, WithoutADisplayNothingIsStarted) {
    for (const std::vector<std::string>& words :
         {std::vector<std::string>{"adjust", "--exposure", "1"}, {"close"}, {"track", "--udp", "0"}}) {
        const Result result = display(words);
        EXPECT_EQ(result.code, 77) << words[0];
        expect_says(result.err, "no display is open");
    }
    EXPECT_TRUE(cluster.status()["live"].is_null()) << "asking for a display must not open a scene";
    EXPECT_EQ(display({"adjust"}).code, 64);
    EXPECT_EQ(display({"adjust", "--layers", "gui"}).code, 64);
    EXPECT_EQ(display({"adjust", "--layers", ","}).code, 64);
    EXPECT_EQ(display({"adjust", "--pattern", "maybe"}).code, 64);
    EXPECT_EQ(display({"track"}).code, 64);
    EXPECT_EQ(display({"track", "--udp", "65536"}).code, 64);
    EXPECT_EQ(display({"open", cluster.folder() / "none.toml"}).code, 2);
}

TEST_F(DisplayProcess, OpenAdjustClose) {
    const Result early = display({"open", file, "--scene", "room"});
    EXPECT_EQ(early.code, 0) << early.err;
    expect_says(early.out, "display 'wall' is open on the live scene 'room'");
    expect_says(early.out, "  tessera-display --master " + cluster.endpoint() + " --keys " + cluster.keys() +
                               " --output left-half\n");
    expect_says(early.err, "nothing is shown yet");
    auto node = cluster.start_node("n1", {"--backend", "null"});
    ASSERT_NO_FATAL_FAILURE(show());
    expect_says(cluster.status()["display"].dump(), "left-half");
    EXPECT_TRUE(is_seen_from({}, 0.064));
    ASSERT_EQ(display({"adjust", "--eye-separation", "0.25"}).code, 0);
    until([&] { return is_seen_from({}, 0.25); });
    ASSERT_EQ(display({"adjust", "--pattern", "on"}).code, 0);
    until([&] { return pattern; });
    EXPECT_TRUE(is_seen_from({}, 0.25)) << "only what is given changes";
    ASSERT_EQ(display({"adjust", "--pattern", "off", "--exposure", "-1.5"}).code, 0);
    until([&] { return !pattern; });
    const Result refused = display({"adjust", "--eye-separation", "-1"});
    EXPECT_EQ(refused.code, 77);
    expect_says(refused.err, "the eye separation is not within 0 and 10 m");
    const Result layers = display({"adjust", "--layers", "0,3"});
    EXPECT_EQ(layers.code, 77);
    expect_says(layers.err, "it has: 0 'solid', 1 'menu'");
    EXPECT_EQ(display({"adjust", "--layers", "1"}).code, 0);
    EXPECT_EQ(display({"close"}).code, 0);
    EXPECT_TRUE(cluster.status()["display"].is_null());
    EXPECT_EQ(display({"close"}).code, 77);
}

TEST_F(DisplayProcess, FollowsATrackedHead) {
    auto node = cluster.start_node("n1", {"--backend", "null"});
    ASSERT_NO_FATAL_FAILURE(show());
    ChildProcess track(cluster.folder().path(), "track", "tessera",
                       with_cluster({"display", "track", "--udp", "0"}));
    const std::string before = "port ";
    until([&] { return track.out().find('\n') != std::string::npos; });
    const int port = std::stoi(track.out().substr(track.out().rfind(before) + before.size()));
    send(port, "0.5 0.25 0");
    until([&] { return is_seen_from({.position = {0.5, 0.25, 0}}, 0.064); });
    send(port, "nowhere");
    send(port, std::string(2000, 'x'));
    send(port, "0 nan 0");
    until([&] { return track.err().find("bad packets, the latest from 127.0.0.1") != std::string::npos; });
    for (int i = 0; i <= 5000; ++i) send(port, "head " + std::to_string(i * 1e-4) + " 0 0 1 0 1 0\n");
    const glm::dquat quarter(std::sqrt(0.5), 0, std::sqrt(0.5), 0);
    until([&] {
        send(port, "head 0.5 0 0 1 0 1 0\n");  // again: of a flood the system may have dropped the last ones
        return is_seen_from({{0.5, 0, 0}, quarter}, 0.064);
    });
    send(port, "0 0 -3");  // behind the wall: the last place stays
    send(port, "0 0 0.5");
    until([&] { return is_seen_from({.position = {0, 0, 0.5}}, 0.064); });
    EXPECT_TRUE(track.running());
    track.signal(SIGINT);
    EXPECT_EQ(track.wait(DisplayPatience).value_or(-1), 0);
    expect_says(track.out(), "3 bad packets");
}

// The example of docs/displays.md.
TEST_F(DisplayProcess, FollowsAHeadFromPython) {
    auto node = cluster.start_node("n1", {"--backend", "null"});
    ASSERT_NO_FATAL_FAILURE(show());
    const std::string source = test::source_folder().string();
    ChildProcess walk(cluster.folder().path(), "walk", "/usr/bin/env",
                      {"PYTHONPATH=" + test::python_package().string(), "PYTHONDONTWRITEBYTECODE=1",
                       TESSERA_PYTHON, source + "/tests/python/run_block.py", source + "/docs/displays.md",
                       cluster.endpoint(), cluster.keys(), cluster.folder().path()});
    const std::size_t before = frames.size();
    until([&] { return !walk.running(); });
    EXPECT_EQ(walk.wait(DisplayPatience).value_or(-1), 0) << walk.err();
    until([&] { return is_seen_from({.position = {-0.5, 0, 0}}, 0.064); });
    EXPECT_GT(frames.size(), before + 2) << "the picture moves with the head";
}

}  // namespace
}  // namespace tessera::test
