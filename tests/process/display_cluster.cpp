#include "tests/process/display_cluster.h"

#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <set>
#include <span>

#include "mediator/picture/png_reader.h"
#include "mediator/scene/fields.h"
#include "tests/support/folders.h"

namespace tessera::test {

using namespace std::chrono_literals;

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

ChildProcess start_with(const std::vector<std::string>& variables, const TemporaryFolder& folder,
                        const std::string& label, const std::string& program,
                        const std::vector<std::string>& arguments) {
    std::vector<std::string> words = variables;
    words.push_back((test::programs_folder() / program).string());
    words.insert(words.end(), arguments.begin(), arguments.end());
    return ChildProcess(folder.path(), label, "/usr/bin/env", words);
}

// So an output that stops is late for four and a half seconds before it is absent.
DisplayCluster::DisplayCluster(int nodes, RealCluster::Session kept)
    : cluster_({"--heartbeat", "1.5"}, kept) {
    for (int i = 0; i < nodes; ++i)
        nodes_.push_back(cluster_.start_node("node-" + std::to_string(i), {"--backend", "null"}));
    begin_scene();
}

void DisplayCluster::begin_scene() {
    editor_ = member("ann");
    const ObjectId camera = editor_->new_id();
    place_ = editor_->new_id();
    const auto made = editor_->submit(
        {scene::Create{camera, scene::Camera{.name = "head"}},
         scene::Create{place_, scene::Transform{.name = "place", .children = {camera}}},
         scene::Update{scene::RootId, scene::Fields<scene::Root>(&scene::Root::children).bits(),
                       scene::Root{.children = {place_}}}});
    EXPECT_TRUE(made.accepted);
}

std::unique_ptr<client::Session> DisplayCluster::member(const std::string& name) {
    auto session = client::connect({cluster_.endpoint(), cluster_.keys()}, blobs_, clock_,
                                   {.name = name, .connect_limit = 60s, .lost_limit = 60s});
    session->join({.title = "wall"}, {});
    return session;
}

std::vector<std::string> DisplayCluster::arguments(const std::string& output,
                                                   std::vector<std::string> more) const {
    more.insert(more.begin(),
                {"--master", cluster_.endpoint(), "--keys", cluster_.keys(), "--output", output});
    return more;
}

ChildProcess DisplayCluster::show(const std::string& output, std::vector<std::string> more) {
    more.insert(more.end(), {"--headless", "--log", folder() / (output + ".log")});
    return ChildProcess(folder().path(), output + "-" + std::to_string(++next_label_), "tessera-display",
                        arguments(output, std::move(more)));
}

std::vector<ShownFrame> DisplayCluster::log(const std::string& output) const {
    std::vector<ShownFrame> frames;
    std::ifstream file(folder() / (output + ".log"));
    for (std::string line; std::getline(file, line);) {
        const auto entry = nlohmann::json::parse(line, nullptr, false);
        if (entry.is_discarded()) continue;  // it is being written
        frames.push_back({.frame = entry["frame"],
                          .epoch = entry["epoch"],
                          .version = entry["version"],
                          .shown = 1e-9 * entry["shown"].get<double>(),
                          .samples = entry["samples"]});
    }
    return frames;
}

std::string DisplayCluster::state(const std::string& output) {
    const nlohmann::json display = cluster_.status()["display"];
    if (display.is_null()) return "";
    for (const auto& entry : display["outputs"]) {
        if (entry["name"] == output) return entry["state"];
    }
    return "";
}

bool DisplayCluster::wait_for_state(const std::string& output, const std::string& wanted) {
    return happens([&] { return state(output) == wanted; });
}

bool DisplayCluster::wait_until_locked(const std::vector<std::string>& outputs) {
    return std::all_of(outputs.begin(), outputs.end(),
                       [&](const std::string& output) { return wait_for_state(output, "locked"); });
}

bool DisplayCluster::wait_until_the_same_is_shown(const std::vector<std::string>& outputs) const {
    return happens([&] {
        std::set<std::uint64_t> latest;
        for (const std::string& output : outputs) {
            const auto frames = log(output);
            latest.insert(frames.empty() ? 0 : frames.back().frame);
        }
        return latest.size() == 1 && *latest.begin() != 0;
    });
}

std::vector<std::uint8_t> DisplayCluster::finished_png(const display::Output& output, std::uint64_t samples) {
    const std::string shown = folder() / "finished";
    ChildProcess process = show(output.name, {"--png", shown});
    EXPECT_TRUE(happens([&] {
        const auto frames = log(output.name);
        return !frames.empty() && frames.back().samples >= samples;
    })) << process.err();
    process.signal(SIGTERM);
    EXPECT_EQ(process.wait(30s).value_or(-1), 0) << process.err();
    return png_bytes(shown + "/" + output.name + ".png", output.width, output.height);
}

std::vector<std::uint8_t> png_bytes(const std::string& path, std::uint32_t width, std::uint32_t height) {
    std::ifstream stream(path, std::ios::binary);
    const std::string file((std::istreambuf_iterator<char>(stream)), {});
    const auto image = picture::read_png(std::as_bytes(std::span(file)));
    if (!image || image->width != width || image->height != height || image->components != 3) {
        ADD_FAILURE() << path << ": " << (image ? "of another size" : image.error().what());
        return {};
    }
    std::vector<std::uint8_t> rgb;
    for (const float value : image->values)
        rgb.push_back(static_cast<std::uint8_t>(std::lround(255.0f * value)));
    return rgb;
}

MovingScene::MovingScene(DisplayCluster& cluster)
    : thread_([&cluster, session = std::shared_ptr(cluster.member("mover"))](std::stop_token stop) {
          for (int step = 1; !stop.stop_requested(); ++step) {
              session->move_head(
                  {.position = {0.3 * std::sin(0.01 * step), 0.1 * std::cos(0.007 * step), 0}});
              if (step % 32 == 0) {
                  scene::Transform moved;
                  moved.matrix[3][0] = 0.01 * step;
                  session->submit_ahead({scene::Update{
                      cluster.place_, scene::Fields<scene::Transform>(&scene::Transform::matrix).bits(),
                      moved}});
                  (void)session->take_results();
              }
              std::this_thread::sleep_for(5ms);
          }
      }) {}

}  // namespace tessera::test
