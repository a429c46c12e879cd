#pragma once

#include <chrono>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "client/session.h"
#include "mediator/display/display.h"
#include "tests/process/real_cluster.h"

namespace tessera::test {

// A line of an output's log, see client/display/frame_log.h.
struct ShownFrame {
    std::uint64_t frame = 0, epoch = 0, version = 0;
    double shown = 0.0;         // seconds
    std::uint64_t samples = 0;  // of a pixel
};

// An output of 64 x 48 pixels that fills this part of a wall two metres in front of the head.
display::Output part_of_wall(const std::string& name, double left, double right);

// A program with environment variables: NAME=VALUE, or "-u" and NAME to unset one.
ChildProcess start_with(const std::vector<std::string>& variables, const TemporaryFolder& folder,
                        const std::string& label, const std::string& program,
                        const std::vector<std::string>& arguments);

// A master, null nodes, a live scene with one movable camera, and an editor client.
class DisplayCluster {
  public:
    explicit DisplayCluster(int nodes, RealCluster::Session kept = RealCluster::Session::None);

    client::Session& editor() { return *editor_; }
    void begin_scene();  // with an editor and a camera, again after it was closed
    RealCluster& cluster() { return cluster_; }
    const TemporaryFolder& folder() const { return cluster_.folder(); }

    // The options of every tessera-display of this cluster.
    std::vector<std::string> arguments(const std::string& output, std::vector<std::string> more) const;
    // Headless, with a log that later processes of this output append to.
    ChildProcess show(const std::string& output, std::vector<std::string> more = {});
    std::vector<ShownFrame> log(const std::string& output) const;
    // As `tessera status` has it: locked, late, absent, joining; "" = no such output.
    std::string state(const std::string& output);
    bool wait_for_state(const std::string& output, const std::string& state);
    bool wait_until_locked(const std::vector<std::string>& outputs);
    // Waits until the latest lines of their logs have the same frame.
    bool wait_until_the_same_is_shown(const std::vector<std::string>& outputs) const;
    // The output's picture with all samples of the display, which is static: shown briefly by a
    // process that writes it as PNG.
    std::vector<std::uint8_t> finished_png(const display::Output& output, std::uint64_t samples);

  private:
    friend class MovingScene;
    std::unique_ptr<client::Session> member(const std::string& name);

    RealCluster cluster_;
    SteadyClock clock_;
    std::shared_ptr<scene::BlobStore> blobs_ = std::make_shared<scene::BlobStore>();
    std::unique_ptr<client::Session> editor_;
    ObjectId place_;
    std::vector<ChildProcess> nodes_;
    int next_label_ = 0;
};

// During its lifetime, the head moves continuously and the camera occasionally, so that new frames of new versions
// are always due. The editor must not be used meanwhile.
class MovingScene {
  public:
    explicit MovingScene(DisplayCluster& cluster);

  private:
    std::jthread thread_;
};

// Red, green and blue bytes; empty, and the test fails, if the file is not a complete PNG of that size.
std::vector<std::uint8_t> png_bytes(const std::string& path, std::uint32_t width, std::uint32_t height);

template <class Done>
bool happens(const Done& done, std::chrono::seconds limit = std::chrono::seconds(30)) {
    const auto deadline = std::chrono::steady_clock::now() + limit;
    while (!done()) {
        if (std::chrono::steady_clock::now() > deadline) return false;
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return true;
}

}  // namespace tessera::test
