// Displays: all outputs show the same frame of the same version, whichever outputs stop, join or leave.
#include <algorithm>
#include <bit>
#include <map>
#include <set>

#include "mediator/display/frustum.h"
#include "mediator/scene/fields.h"
#include "tests/cluster/display_fixture.h"
#include "tests/cluster/raw_peer.h"

namespace tessera::test {
namespace {

using namespace std::chrono_literals;

TEST_F(Displays, AllOutputsPresentTheSameFramesOfTheSameVersion) {
    cluster.add_node("null");
    cluster.add_node("null");
    ann->open_display(wall);
    show("left");
    show("right");
    until([&] { return all_show(4); });
    for (int i = 1; i < 10; ++i) {
        const std::uint64_t before = output_clients["left"].frames.back().version.number;
        move_camera(0.1 * i);
        until([&] { return all_show(4) && output_clients["left"].frames.back().version.number > before; });
    }
    std::map<std::uint64_t, std::set<std::uint64_t>> versions, samples;
    std::map<std::uint64_t, int> seen;
    for (const auto& [name, output_client] : output_clients) {
        std::uint64_t last = 0;
        for (const session::PresentFrame& order : output_client.orders) {
            EXPECT_GT(order.frame, last) << "frames must get newer";
            last = order.frame;
            ++seen[order.frame];
            versions[order.frame].insert(order.version.number);
        }
        for (const client::OutputFrame& frame : output_client.frames) {
            versions[frame.number].insert(frame.version.number);
            samples[frame.number].insert(frame.samples);
        }
    }
    for (const auto& [frame, numbers] : versions) EXPECT_EQ(numbers.size(), 1u) << "frame " << frame;
    for (const auto& [frame, counts] : samples) EXPECT_EQ(counts.size(), 1u) << "frame " << frame;
    EXPECT_GT(std::count_if(seen.begin(), seen.end(), [](const auto& entry) { return entry.second == 2; }),
              10);
    until([&] { return status().display.outputs.at(1).samples == 4; });
    const auto now = status().display;
    EXPECT_EQ(now.name, "wall");
    ASSERT_EQ(now.outputs.size(), 2u);
    EXPECT_EQ(now.outputs[0].state, session::OutputState::Locked);
    EXPECT_EQ(now.outputs[0].samples, 4u);
}

TEST_F(Displays, CoarsePicturesAreSentFirst) {
    cluster.add_node("null");
    for (display::Output& output : wall.outputs) {
        output.width = output.view_width = 256;
        output.height = output.view_height = 192;
    }
    show("left");
    show("right");
    ann->open_display(wall);
    until([&] {
        for (auto& [name, output_client] : output_clients) {
            if (!output_client.problem.empty()) {
                output_client.problem.clear();
                output_client.session->join_output(name);
            }
        }
        return all_show(4) && output_clients["left"].frames.back().pictures[0].width == 256;
    });
    EXPECT_EQ(output_clients["left"].frames.front().pictures.at(0).bytes.size(),
              std::size_t{3} * output_clients["left"].frames.front().pictures[0].width *
                  output_clients["left"].frames.front().pictures[0].height);
}

TEST_F(Displays, OutputsRefineTogether) {
    cluster.add_node("null", {}, 1us);
    wall.spp = 32;
    ann->open_display(wall);
    show("left");
    show("right");
    until([&] { return all_show(32); });
    std::map<std::uint64_t, std::uint64_t> left;
    std::set<std::uint64_t> seen;
    for (const client::OutputFrame& frame : output_clients["left"].frames) left[frame.number] = frame.samples;
    for (const client::OutputFrame& frame : output_clients["right"].frames) {
        if (left.contains(frame.number)) {
            EXPECT_EQ(left[frame.number], frame.samples) << "frame " << frame.number;
        }
        EXPECT_TRUE(std::has_single_bit(frame.samples));
        seen.insert(frame.samples);
    }
    EXPECT_GE(seen.size(), 3u) << "not only the last stage";
}

// With a denoiser, whose film says where there is noise: each view has masks of its own, all are shown in lockstep.
TEST_F(Displays, OutputsAndEyesGetTheirSamplesWhereTheyAreNeeded) {
    cluster.add_node("embree");
    cluster.add_node("embree");
    wall.spp = 256;
    wall.filter = "gauss";
    wall.outputs[0].stereo = display::Stereo::SideBySide;
    wall.outputs[1].priority = 2;
    ann->open_display(wall);
    show("left");
    show("right");
    // Mean samples of two eyes, and of an output that may have twice as many.
    const auto means = [&] {
        std::map<std::string, std::uint64_t> means;
        for (const session::ViewEntry& view : ann->members().views) {
            EXPECT_EQ(view.spp, view.name == "display/right" ? 512u : 256u);
            EXPECT_LE(view.samples, view.spp);
            means[view.name] = view.samples;
        }
        return means;
    };
    const auto settled = [&] {
        const auto before = means();
        std::this_thread::sleep_for(1s);
        const auto now = means();
        return before == now && now.size() == 3 &&
               std::ranges::all_of(now, [](const auto& view) { return view.second > 16; });
    };
    until(settled);
    until([&] { return all_show(16); });
    const auto at_the_end = means();
    // The edges of a triangle have noise, the rest has none: as many in all pixels would be a power of two.
    for (const auto& [name, mean] : at_the_end) EXPECT_FALSE(std::has_single_bit(mean)) << name;
    EXPECT_EQ(output_clients["right"].frames.back().samples, at_the_end.at("display/right"));
    move_camera(0.5);  // a change begins again
    until([&] { return means() != at_the_end; });
    until(settled);
}

TEST_F(Displays, WithoutLightRefineInAllPixels) {
    cluster.add_node("embree");
    wall.spp = 32;
    wall.filter = "gauss";
    submit({scene::Update{ObjectId{first.value + 1},
                          scene::Fields<scene::Material>(&scene::Material::emission).bits(),
                          scene::Material{.emission = glm::vec3(0.0f)}}});
    ann->open_display(wall);
    show("left");
    show("right");
    until([&] { return all_show(32); });
}

TEST_F(Displays, AnOutputWithPriorityHasMoreSamples) {
    cluster.add_node("null");
    wall.outputs[1].priority = 4;
    ann->open_display(wall);
    show("left");
    show("right");
    until([&] { return shows(output_clients["left"], 4) && shows(output_clients["right"], 16); });
    for (const client::OutputFrame& left : output_clients["left"].frames) {
        for (const client::OutputFrame& right : output_clients["right"].frames) {
            if (left.number == right.number) {  // coarse pictures have one sample a pixel
                const bool is_coarse = right.pictures[0].width < 64;
                EXPECT_EQ((is_coarse ? 1 : 4) * left.samples, right.samples);
            }
        }
    }
}

TEST_F(Displays, AnOutputThatStopsIsDroppedAndComesBack) {
    cluster.add_node("null");
    ann->open_display(wall);
    OutputClient& left = show("left");
    OutputClient& right = show("right");
    until([&] { return all_show(4); });
    right.answers = false;
    move_camera(1.0);
    const std::size_t before = left.orders.size();
    until([&] { return left.orders.size() > before + 1 && shows(left, 4); });
    auto outputs = status().display.outputs;
    EXPECT_EQ(outputs[0].state, session::OutputState::Locked);
    EXPECT_EQ(outputs[1].state, session::OutputState::Late);
    EXPECT_EQ(outputs[1].late, 1u);
    right.answers = true;
    const std::size_t right_before = right.orders.size();
    right.session->output_ready(right.frames.back().number);  // it goes on where it stopped
    until([&] { return right.orders.size() > right_before && shows(right, 4); });
    EXPECT_EQ(right.orders.back().frame, left.orders.back().frame);
    EXPECT_EQ(status().display.outputs[1].state, session::OutputState::Locked);
}

TEST_F(Displays, AnOutputThatJoinsLaterGetsTheCurrentFrame) {
    cluster.add_node("null");
    ann->open_display(wall);
    OutputClient& left = show("left");
    until([&] { return all_show(4); });
    const std::size_t before = left.orders.size();
    OutputClient& right = show("right");
    until([&] { return all_show(4); });
    EXPECT_EQ(right.orders.back().frame, left.orders.back().frame);
    EXPECT_EQ(left.orders.size(), before) << "the others must not be affected";
    right.session.reset();
    output_clients.erase("right");
    until([&] { return status().display.outputs[1].state == session::OutputState::Absent; });
    move_camera(2.0);
    until([&] { return left.orders.size() > before && all_show(4); });
}

TEST_F(Displays, NoPicturesAreSentBeforeTheDisplayIsLoaded) {
    cluster.add_node("null");
    ann->open_display(wall);
    OutputClient& left = show("left");
    OutputClient& right = show("right");
    right.opens = false;
    until([&] { return shows(left, 4) && !right.opened.empty(); });
    move_camera(1.0);
    const std::size_t before = left.orders.size();
    until([&] { return left.orders.size() > before && shows(left, 4); });
    EXPECT_TRUE(right.frames.empty());
    EXPECT_EQ(status().display.outputs[1].state, session::OutputState::Joining);
    EXPECT_EQ(status().display.outputs[1].late, 0u) << "it must not be waited for";
    wall.name = "another";
    ann->open_display(wall);
    until([&] { return right.opened.size() == 2; });
    right.session->output_ready(0);  // of the first
    until([&] { return shows(left, 4); });
    EXPECT_TRUE(right.frames.empty());
    right.session->output_ready(0);
    until([&] { return all_show(4); });
}

TEST_F(Displays, OutputsAreNotifiedWhenTheirDisplayIsClosed) {
    cluster.add_node("null");
    ann->open_display(wall);
    OutputClient& left = show("left");
    OutputClient& right = show("right");
    until([&] { return all_show(4); });
    wall.outputs.pop_back();
    ann->open_display(wall);
    until([&] { return !right.problem.empty(); });
    EXPECT_NE(right.problem.find("no output 'right'"), std::string::npos) << right.problem;
    EXPECT_TRUE(left.problem.empty()) << left.problem;
    ann->close_display();
    until([&] { return !left.problem.empty(); });
    EXPECT_NE(left.problem.find("closed"), std::string::npos) << left.problem;
}

TEST_F(Displays, HeadsMoveAndTheLatestPoseIsUsed) {
    cluster.add_node("null");
    ann->open_display(wall);
    OutputClient& left = show("left");
    until([&] { return all_show(4); });
    for (int i = 0; i <= 200; ++i) ann->move_head({.position = {0.005 * i, 0, 0}});
    ann->move_head({.position = {0, 0, -3}});     // behind the wall: nothing could be seen
    ann->move_head({.position = {0, 0, 1e300}});  // nowhere
    until([&] {
        return shows(left, 4) && left.frames.back().pictures[0].camera.world_from_camera[3][0] == 1.0;
    });
    EXPECT_LT(left.frames.size(), 201u);
    const view::CameraPose expected =
        display::frustum(wall.outputs[0].plane, {.position = {1, 0, 0}}, view::Eye::Mono, 0, 0);
    EXPECT_EQ(left.frames.back().pictures[0].camera, expected);
}

// All samples are kept while more are rendered.
TEST_F(Displays, ExposureChangesPicturesWithoutRenderingAgain) {
    cluster.add_node("embree");
    wall.spp = 64;
    ann->open_display(wall);
    OutputClient& left = show("left");
    show("right");
    until([&] { return shows(left, 2); });
    const auto exposed = [&](double stops, std::uint64_t samples) {
        const std::size_t before = left.frames.size();
        const std::uint64_t had = left.frames.back().samples;
        ann->adjust_display({.exposure = stops});
        until([&] { return left.frames.size() > before && all_show(samples); });
        for (std::size_t i = before; i < left.frames.size(); ++i) EXPECT_GE(left.frames[i].samples, had);
    };
    for (int i = 1; i < 8; ++i) exposed(-0.5 * i, 2);
    exposed(-8.0, 64);
    until([&] { return status().display.outputs.at(1).samples == 64; });
    const auto dark = left.frames.back().pictures[0].bytes;
    exposed(0.0, 64);
    until([&] { return left.frames.back().pictures[0].bytes > dark && all_show(64); });
    EXPECT_EQ(left.orders.back().frame, output_clients["right"].orders.back().frame);
}

// The camera is found by its name; creating it at the origin must not change the picture.
TEST_F(Displays, TheCameraMayBeCreatedLaterAndRemoved) {
    cluster.add_node("null");
    const auto rename_camera = [&](const std::string& name) {
        submit({scene::Update{camera_id(), scene::Fields<scene::Camera>(&scene::Camera::name).bits(),
                              scene::Camera{.name = name}}});
    };
    const auto is_logged = [&] {
        const auto events = cluster.events();
        return std::any_of(events.begin(), events.end(), [](const std::string& event) {
            return event.find("display 'wall' waits: the scene has no camera 'stage'") != std::string::npos;
        });
    };
    wall.camera = "stage";
    ann->open_display(wall);
    OutputClient& left = show("left");
    until([&] { return !left.opened.empty() && is_logged(); });
    EXPECT_EQ(status().scene.views, 0u);
    EXPECT_TRUE(left.frames.empty());
    rename_camera("stage");
    until([&] { return all_show(4); });
    rename_camera("main");
    until([&] { return status().scene.views == 0; });
    const std::size_t before = left.frames.size();
    rename_camera("stage");
    until([&] { return left.frames.size() > before && all_show(4); });
}

TEST_F(Displays, InvalidDisplaysAreRefusedWithAReason) {
    const auto refused = [&](const auto& act, const std::string& reason) {
        try {
            act();
            ADD_FAILURE() << "not refused: " << reason;
        } catch (const Error& error) {
            EXPECT_NE(std::string(error.what()).find(reason), std::string::npos) << error.what();
        }
    };
    refused([&] { ann->adjust_display({.exposure = 1.0}); }, "no display is open");
    refused([&] { ann->close_display(); }, "no display is open");
    display::Display bad = wall;
    bad.outputs[1].name = "left";
    refused([&] { ann->open_display(bad); }, "two outputs have the name 'left'");
    bad = wall;
    bad.head.position = {0, 0, -2};
    refused([&] { ann->open_display(bad); }, "in front of the screen");
    bad = wall;
    bad.head.position = {0, 0, 1e7};
    refused([&] { ann->open_display(bad); }, "1000 km");
    bad = wall;
    bad.filter = "nonesuch";
    refused([&] { ann->open_display(bad); }, "nonesuch");
    bad = wall;
    bad.outputs[0].points = {2, 2, 3, display::Grid::Nodes::Edges, {blake2b({}), 48}};
    refused([&] { ann->open_display(bad); }, "does not have blob");
    ann->open_display(wall);
    refused([&] { ann->adjust_display({.eye_separation = -1.0}); }, "eye separation");
    refused([&] { ann->adjust_display({.shown_layers = 1}); }, "no layers to choose from");
    wall.layers = {{.name = "solid"}, {.name = "menu"}};
    ann->open_display(wall);
    refused([&] { ann->adjust_display({.shown_layers = 4}); }, "it has: 0 'solid', 1 'menu'");
    refused([&] { ann->adjust_display({.shown_layers = 0}); }, "no layer of the display is shown");
    ann->adjust_display({.shown_layers = 2});
    OutputClient& center = show("middle");
    until([&] { return !center.problem.empty(); });
    EXPECT_NE(center.problem.find("no output 'middle'; it has: left, right"), std::string::npos);
    show("left");
    until([&] { return !output_clients["left"].opened.empty(); });
    const auto twin = cluster.member("twin", std::make_shared<scene::BlobStore>(), net::Role::Viewer);
    twin->join_output("left");
    const auto event = twin->next_output_event(std::chrono::steady_clock::now() + 30s, {});
    ASSERT_TRUE(event && std::holds_alternative<client::OutputUnavailable>(*event));
    EXPECT_NE(std::get<client::OutputUnavailable>(*event).reason.find("shown already"), std::string::npos);
    const auto viewer = cluster.member("viewer", blobs, net::Role::Viewer);
    viewer->move_head({.position = {9, 9, 9}});  // dropped: viewers move nothing
    ann->close_display();
    EXPECT_EQ(status().display.name, "");
}

// Nothing is assumed about the order between its links.
TEST_F(Displays, AnOutputWithADelayedBulkLinkGetsItsFrames) {
    cluster.add_node("null");
    ann->open_display(wall);
    RawPeer peer(cluster.channel(net::Role::Viewer));
    const auto poll_until = [&](const auto& done) {
        const auto deadline = std::chrono::steady_clock::now() + 30s;
        while (!done() && std::chrono::steady_clock::now() < deadline) {
            for (auto& [name, output_client] : output_clients) output_client.step();
            peer.poll();
        }
        return done();
    };
    peer.send(wire::Hello{.name = "late"});
    ASSERT_TRUE(peer.wait_for<wire::Welcome>());
    peer.send(wire::JoinScene{.title = "test", .name = "late"});
    peer.send(wire::JoinOutput{.request = 1, .name = "left"});
    ASSERT_TRUE(peer.wait_for<wire::OutputOpened>());
    peer.send(wire::OutputReady{});
    OutputClient& right = show("right");  // so there are frames
    ASSERT_TRUE(poll_until([&] { return shows(right, 4); }));
    EXPECT_EQ(status().display.outputs[0].late, 0u) << "it must not have been waited for";
    peer.send(wire::BulkHello{peer.received<wire::Welcome>()->token});
    EXPECT_TRUE(poll_until([&] { return peer.received<wire::OutputPicture>() != nullptr; }));
}

TEST_F(Displays, ThePatternIsSwitchedOnForAll) {
    ann->open_display(wall);
    show("left");
    show("right");
    until([&] { return !output_clients["left"].opened.empty() && !output_clients["right"].opened.empty(); });
    ann->adjust_display({.pattern = true});
    until([&] {
        return output_clients["left"].opened.back().pattern && output_clients["right"].opened.back().pattern;
    });
}

}  // namespace
}  // namespace tessera::test
