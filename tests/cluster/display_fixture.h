#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "mediator/display/display.h"
#include "tests/cluster/loopback_cluster.h"

namespace tessera::test {

// 64x48 pixels on a wall two metres in front of the camera, from `left` to `right` and one metre up and down.
display::Output part_of_wall(const std::string& name, double left, double right);

// One output process: answers like tessera-display.
struct OutputClient {
    std::unique_ptr<client::Session> session;
    std::vector<client::OutputFrame> frames;
    std::vector<session::PresentFrame> orders;
    std::vector<session::OutputOpened> opened;
    std::string problem;
    bool answers = true, opens = true;

    void step();  // takes all that has come
};

// A live scene with a camera below a transform, and a display of two outputs, "left" and "right", not open
// yet.
struct Displays : testing::Test {
    LoopbackCluster cluster;
    std::shared_ptr<scene::BlobStore> blobs = std::make_shared<scene::BlobStore>();
    std::unique_ptr<client::Session> ann = cluster.member("ann", blobs);
    ObjectId first = ann->new_id();
    display::Display wall{.name = "wall"};
    std::map<std::string, OutputClient> output_clients;

    void SetUp() override;
    ObjectId camera_id() const { return ObjectId{first.value + 6}; }
    ObjectId place_id() const { return ObjectId{first.value + 7}; }

    OutputClient& show(const std::string& output);
    template <class Done>
    void until(const Done& done) {
        const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
        while (!done()) {
            for (auto& [name, output_client] : output_clients) output_client.step();
            if (std::chrono::steady_clock::now() > deadline) {
                FAIL() << "timed out";
            }
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
    }
    // True if the latest frame received is the one presented, with at least this many samples.
    static bool shows(const OutputClient& output_client, std::uint64_t samples);
    bool all_show(std::uint64_t samples) const;
    session::ClusterStatus status();
    void submit(const std::vector<scene::Entry>& entries);
    void move_camera(double x);
};

}  // namespace tessera::test
