#include "client/display/output_player.h"

#include <time.h>

#include <algorithm>
#include <functional>

#include "mediator/display/pattern_run.h"
#include "mediator/wire/display_codec.h"

namespace tessera::client_display {

namespace {

constexpr Duration AskAgain = std::chrono::milliseconds(500);

// On the clock of the master's present times.
void sleep_until(std::int64_t nanoseconds) {
    const timespec when{.tv_sec = nanoseconds / 1'000'000'000, .tv_nsec = nanoseconds % 1'000'000'000};
    while (::clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &when, nullptr) == EINTR) {
    }
}

display::EyePicture as_picture(const client::OutputFrame::Picture& picture) {
    using Encoding = display::EyePicture::Encoding;
    return {.encoding = picture.encoding == session::PictureEncoding::Half ? Encoding::LinearHalf
                                                                           : Encoding::SrgbBytes,
            .width = picture.width,
            .height = picture.height,
            .values = picture.bytes};
}

}  // namespace

OutputPlayer::OutputPlayer(client::Session& session, scene::BlobStore& blobs, const Clock& clock,
                           std::string output, MakePresenter make_presenter, FrameLog& log,
                           std::function<void(const std::string&)> report)
    : session_(session),
      blobs_(blobs),
      clock_(clock),
      name_(std::move(output)),
      make_presenter_(std::move(make_presenter)),
      log_(log),
      report_(std::move(report)) {}

void OutputPlayer::run(std::uint64_t frames, std::stop_token stop) {
    session_.join_output(name_);
    while (!stop.stop_requested() && (frames == 0 || shown_ < frames)) {
        TimePoint until = clock_.now() + std::chrono::seconds(1);
        if (ask_again_) until = std::min(until, *ask_again_);
        if (presenter_ && presenter_->attention_milliseconds() > 0)
            until = std::min(until,
                             clock_.now() + std::chrono::milliseconds(presenter_->attention_milliseconds()));
        if (auto event = session_.next_output_event(until, stop))
            std::visit([this](auto&& body) { take(std::forward<decltype(body)>(body)); }, *std::move(event));
        for (const std::string& notice : session_.take_notices()) report_(notice);
        if (ask_again_ && clock_.now() >= *ask_again_) {
            ask_again_.reset();
            session_.join_output(name_);
        }
        if (presenter_ && !presenter_->attend()) return;
    }
}

void OutputPlayer::take(const client::OutputUnavailable& unavailable) {
    if (reported_ != unavailable.reason) report_(unavailable.reason + "; waiting");
    reported_ = unavailable.reason;
    ask_again_ = clock_.now() + AskAgain;
}

void OutputPlayer::take(const session::OutputOpened& opened) {
    try {
        open(opened);
    } catch (const Error& error) {
        if (error.code() != ErrorCode::NotFound) throw;
        return take(client::OutputUnavailable{"the display was closed"});  // while joining
    }
    session_.output_ready(0);  // ready for pictures
}

void OutputPlayer::open(const session::OutputOpened& opened) {
    reported_.clear();
    if (!pipeline_ || opened.description != description_ || output_.name != name_) {
        auto display = wire::decode_display(session_.fetch(opened.description)->bytes());
        if (!display) throw display.error();
        if (opened.index >= display->outputs.size())
            throw Error(ErrorCode::InvalidInput,
                        "the master opened an output that its display does not have");
        const display::Output output = display->outputs[opened.index];
        std::vector<scene::BlobPtr> arrays;
        for (const display::Grid& grid : {output.points, output.blend.weights, output.blend.lift}) {
            if (!grid.empty()) arrays.push_back(session_.fetch(grid.values));
        }
        auto pipeline = std::make_unique<display::OutputPipeline>(output, blobs_);
        const bool other_device = !presenter_ || output.width != output_.width ||
                                  output.height != output_.height || output.stereo != output_.stereo ||
                                  output.x != output_.x || output.y != output_.y;
        pipeline_ = std::move(pipeline);
        display_ = std::move(*display);
        output_ = output;
        arrays_ = std::move(arrays);
        description_ = opened.description;
        devices_.assign(pipeline_->picture_count(), std::vector<std::uint8_t>(pipeline_->value_count()));
        if (other_device) {
            presenter_.reset();
            presenter_ = make_presenter_(output_);
        }
        prepared_.reset();
        latest_.reset();
        report_("shows output '" + name_ + "', " + std::to_string(output_.width) + "x" +
                std::to_string(output_.height));
    }
    const bool was_pattern = std::exchange(pattern_, opened.pattern);
    if (pattern_ && !was_pattern) show_pattern();
    if (!pattern_ && was_pattern && latest_) {
        client::OutputFrame frame = *std::exchange(latest_, std::nullopt);
        const std::uint64_t number = frame.number;
        take(std::move(frame));
        presenter_->present(number);
        prepared_.reset();
    }
}

void OutputPlayer::make(std::span<const display::EyePicture> pictures) {
    const std::vector<std::span<std::uint8_t>> devices(devices_.begin(), devices_.end());
    (void)pipeline_->run(arena_, pictures, devices);
    presenter_->prepare(devices_);
}

void OutputPlayer::show_pattern() {
    const std::vector<std::span<std::uint8_t>> devices(devices_.begin(), devices_.end());
    display::run_pattern(arena_, *pipeline_, output_, display_, devices);
    presenter_->prepare(devices_);
    presenter_->present(0);
}

void OutputPlayer::take(client::OutputFrame&& frame) {
    if (!pipeline_ || frame.pictures.size() != pipeline_->eye_count()) return;  // of an earlier display
    if (!pattern_) {
        std::vector<display::EyePicture> pictures;
        for (const client::OutputFrame::Picture& picture : frame.pictures) {
            pipeline_->set_frustum(picture.eye, picture.camera);
            pictures.push_back(as_picture(picture));
        }
        make(pictures);
        prepared_ = Prepared{frame.number, frame.samples};
    }
    session_.output_ready(frame.number);
    latest_ = std::move(frame);
}

void OutputPlayer::take(const session::PresentFrame& order) {
    if (!prepared_ || prepared_->frame != order.frame || pattern_) return;
    if (order.at != 0) sleep_until(order.at);
    presenter_->present(order.frame);
    log_.add({.output = name_,
              .frame = order.frame,
              .version = order.version,
              .at = order.at,
              .shown = clock_.now().time_since_epoch().count(),
              .bound = order.bound,
              .samples = prepared_->samples});
    prepared_.reset();
    ++shown_;
}

}  // namespace tessera::client_display
