#pragma once

#include <tbb/task_arena.h>

#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "client/display/frame_log.h"
#include "client/display/presenter.h"
#include "client/session.h"
#include "mediator/display/output_pipeline.h"

namespace tessera::client_display {

// Shows one output of the display of a live scene: computes the device's picture from the master's pictures, reports
// ready, presents at the given time. If there is no such output yet it retries.
class OutputPlayer {
  public:
    // `report`: receives messages for the user. All references must outlive the player.
    OutputPlayer(client::Session& session, scene::BlobStore& blobs, const Clock& clock, std::string output,
                 MakePresenter make_presenter, FrameLog& log, std::function<void(const std::string&)> report);

    // Runs until a stop, the closing of the window or this many frames (0 = unlimited). Throws Error when the connection to
    // the master is lost.
    void run(std::uint64_t frames, std::stop_token stop);

  private:
    // A prepared frame.
    struct Prepared {
        std::uint64_t frame = 0;
        std::uint64_t samples = 0;
    };

    void take(const session::OutputOpened& opened);
    void take(client::OutputFrame&& frame);
    void take(const session::PresentFrame& order);
    void take(const client::OutputUnavailable& unavailable);
    void open(const session::OutputOpened& opened);
    void show_pattern();
    void make(std::span<const display::EyePicture> pictures);

    client::Session& session_;
    scene::BlobStore& blobs_;
    const Clock& clock_;
    std::string name_;
    MakePresenter make_presenter_;
    FrameLog& log_;
    std::function<void(const std::string&)> report_;
    tbb::task_arena arena_;
    display::Display display_;
    display::Output output_;
    scene::BlobRef description_;
    std::vector<scene::BlobPtr> arrays_;
    bool pattern_ = false;
    std::unique_ptr<display::OutputPipeline> pipeline_;
    std::unique_ptr<Presenter> presenter_;
    std::vector<std::vector<std::uint8_t>> devices_;
    std::optional<Prepared> prepared_;
    std::optional<client::OutputFrame> latest_;  // shown again after the pattern
    std::optional<TimePoint> ask_again_;
    std::string reported_;
    std::uint64_t shown_ = 0;
};

}  // namespace tessera::client_display
