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

// Shows one output of the display in front of a live scene: makes the device's picture of what the master
// sends, says ready, presents when it is told to. When there is no such output (yet) it asks again.
class OutputPlayer {
  public:
    // `tell`: what a person should know. All must outlive the player.
    OutputPlayer(client::Session& session, scene::BlobStore& blobs, const Clock& clock, std::string output,
                 MakePresenter make_presenter, FrameLog& log, std::function<void(const std::string&)> tell);

    // Until the stop, the end of the window or so many frames (0 = without end). Throws Error when the master
    // is gone for good.
    void run(std::uint64_t frames, std::stop_token stop);

  private:
    // A frame that is ready.
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
    std::function<void(const std::string&)> tell_;
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
    std::optional<client::OutputFrame> latest_;  // to go back to after the pattern
    std::optional<TimePoint> ask_again_;
    std::string told_;
    std::uint64_t shown_ = 0;
};

}  // namespace tessera::client_display
