#include "tests/cluster/display_fixture.h"

#include <algorithm>

#include "mediator/scene/fields.h"
#include "tests/cluster/cluster_scene.h"

namespace tessera::test {

using namespace scene;

display::Output part_of_wall(const std::string& name, double left, double right) {
    display::Output output{.name = name, .width = 64, .height = 48};
    output.view_width = 64;
    output.view_height = 48;
    output.plane = {{left, -1, -2},
                    {1, 0, 0},
                    {0, 1, 0},
                    {{left, -1, -2}, {right, -1, -2}, {left, 1, -2}, {right, 1, -2}}};
    return output;
}

void OutputClient::step() {
    while (auto event = session->next_output_event(std::chrono::steady_clock::now(), {})) {
        if (auto* frame = std::get_if<client::OutputFrame>(&*event)) {
            if (answers) session->output_ready(frame->number);
            frames.push_back(std::move(*frame));
        } else if (const auto* order = std::get_if<session::PresentFrame>(&*event)) {
            orders.push_back(*order);
        } else if (const auto* open = std::get_if<session::OutputOpened>(&*event)) {
            if (opens) session->output_ready(0);
            opened.push_back(*open);
        } else {
            problem = std::get<client::OutputUnavailable>(*event).reason;
        }
    }
}

void Displays::SetUp() {
    for (int i = 0; i < 8; ++i) ann->new_id();
    submit(scene_entries(first, *blobs));
    submit({Create{camera_id(), Camera{.name = "main"}},
            Create{place_id(), Transform{.name = "place", .children = {camera_id()}}},
            Update{RootId, Fields<Root>(&Root::children).bits(), Root{.children = {first, place_id()}}}});
    wall.outputs = {part_of_wall("left", -2, 0), part_of_wall("right", 0, 2)};
    wall.spp = 4;
    wall.rate = 1000;
}

OutputClient& Displays::show(const std::string& output) {
    OutputClient& output_client = output_clients[output];
    output_client.session = cluster.member(output, std::make_shared<BlobStore>(), net::Role::Viewer);
    output_client.session->join_output(output);
    return output_client;
}

bool Displays::shows(const OutputClient& output_client, std::uint64_t samples) {
    return !output_client.orders.empty() && !output_client.frames.empty() &&
           output_client.frames.back().samples >= samples &&
           output_client.orders.back().frame == output_client.frames.back().number;
}

bool Displays::all_show(std::uint64_t samples) const {
    return std::all_of(output_clients.begin(), output_clients.end(),
                       [&](const auto& entry) { return shows(entry.second, samples); });
}

session::ClusterStatus Displays::status() {
    return cluster.session(std::make_shared<BlobStore>())->status();
}

void Displays::submit(const std::vector<Entry>& entries) {
    ASSERT_TRUE(ann->submit(entries).accepted);
}

void Displays::move_camera(double x) {
    Transform moved;
    moved.matrix[3][0] = x;
    submit({Update{place_id(), Fields<Transform>(&Transform::matrix).bits(), moved}});
}

}  // namespace tessera::test
