// Displays: opening, adjusting, and showing an output.
#include "client/session_exchange.h"
#include "mediator/wire/display_codec.h"

namespace tessera::client {

void Session::open_display(const display::Display& display) {
    Implementation& self = *implementation_;
    const scene::BlobPtr description =
        self.blobs->insert(wire::encode(display));  // kept until it is answered
    self.send_and_confirm(wire::OpenDisplay{.description = scene::reference(*description)});
}

void Session::close_display() {
    implementation_->send_and_confirm(wire::CloseDisplay{});
}

void Session::adjust_display(const session::DisplayAdjustment& adjustment) {
    implementation_->send_and_confirm(wire::AdjustDisplay{.adjustment = adjustment});
}

void Session::move_head(const display::Head& head) {
    Implementation& self = *implementation_;
    if (self.state == Implementation::State::Joined) self.link.send(wire::MoveHead{head});
}

void Session::join_output(const std::string& name) {
    implementation_->output = name;
    implementation_->ask_for_output();
}

std::optional<OutputEvent> Session::next_output_event(TimePoint deadline, std::stop_token stop) {
    Implementation& self = *implementation_;
    while (self.output_events.empty()) {
        self.throw_refusals();
        if (stop.stop_requested() || !self.receive_next(deadline, stop)) return std::nullopt;
    }
    OutputEvent event = std::move(self.output_events.front());
    self.output_events.pop_front();
    return event;
}

void Session::output_ready(std::uint64_t frame) {
    implementation_->link.send(wire::OutputReady{frame});
}

void Session::Implementation::ask_for_output() {
    output_request = ++last_request;
    if (state == State::Joined) link.send(wire::JoinOutput{output_request, output});
}

// Whether the message was about the output that this session shows.
bool Session::Implementation::take_for_output(wire::ControlMessage& message) {
    if (auto* opened = std::get_if<wire::OutputOpened>(&message)) {
        output_events.emplace_back(std::move(opened->output));
        return true;
    }
    if (const auto* order = std::get_if<wire::PresentFrame>(&message)) {
        output_events.emplace_back(order->order);
        return true;
    }
    const auto* done = std::get_if<wire::RequestDone>(&message);
    if (done == nullptr || output_request == 0 || done->request != output_request) return false;
    output_events.emplace_back(OutputUnavailable{done->text});
    return true;
}

}  // namespace tessera::client
