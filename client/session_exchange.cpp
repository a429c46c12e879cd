#include "client/session_exchange.h"

#include <random>

namespace tessera::client {

namespace {

std::uint64_t random_key() {
    std::random_device device;
    std::uint64_t key = 0;
    while (key == 0) key = (std::uint64_t{device()} << 32) | device();
    return key;
}

// The number of the request that a message answers; 0 for other messages.
std::uint64_t request_of(const wire::ControlMessage& message) {
    return std::visit(
        [](const auto& content) -> std::uint64_t {
            if constexpr (requires { content.request; }) return content.request;
            return 0;
        },
        message);
}

}  // namespace

Session::Implementation::Implementation(std::unique_ptr<net::Channel> channel,
                                        std::function<void()> reconnect,
                                        std::shared_ptr<scene::BlobStore> store, const Clock& time,
                                        SessionSettings how)
    : link(std::move(channel), std::move(reconnect), store, time, how),
      blobs(store),
      clock(time),
      settings(std::move(how)),
      fetcher(store, wire::BlobLimits{}) {
    join_request.key = random_key();
    id = SessionId{link.join()};
}

// ---- received messages ----

bool Session::Implementation::receive_next(TimePoint deadline, std::stop_token stop) {
    auto incoming = link.next(deadline, stop);
    if (settings.stop.stop_requested()) {
        if (!interrupted_at) interrupted_at = clock.now();
        if (!incoming && link.is_silent() && clock.now() - *interrupted_at >= InterruptedWait)
            throw Error(ErrorCode::Unavailable, "interrupted, and the master does not answer");
    }
    if (!incoming) return false;
    std::visit([this](auto&& content) { take(std::forward<decltype(content)>(content)); },
               *std::move(incoming));
    return true;
}

void Session::Implementation::take(Rejoined&& rejoined) {
    notify_away(false);
    if (state == State::Joined && !rejoined.same_session) state = State::Joining;
    if (state == State::Joining) {
        join_request.no_wait = false;
        return link.send(join_request);
    }
    resend();
}

void Session::Implementation::take(wire::ControlMessage&& message) {
    if (const auto* welcome = std::get_if<wire::SceneJoined>(&message)) return take(*welcome);
    if (auto* reply = std::get_if<wire::StatusReply>(&message)) {
        status = std::move(*reply);
        return;
    }
    // Messages sent between the new hello and the new join were refused; they are sent again.
    if (state == State::Joining) return;
    if (auto* reply = std::get_if<wire::EditReply>(&message)) return take(std::move(*reply));
    if (auto* notice = std::get_if<wire::Notice>(&message)) {
        notices.push_back(std::move(notice->text));
        return;
    }
    if (const auto* refusal = std::get_if<wire::Refusal>(&message)) {
        refusals.push_back(refusal->reason);
        return;
    }
    if (take_for_output(message) || take_for_view(message)) return;
    const std::uint64_t request = request_of(message);
    if (request == 0) {
        // An asynchronous camera change was refused.
        if (const auto* done = std::get_if<wire::RequestDone>(&message)) refusals.push_back(done->text);
        return;
    }
    if (asked.erase(request) > 0) answers.insert_or_assign(request, std::move(message));
}

void Session::Implementation::take(const wire::SceneJoined& welcome) {
    if (welcome.queue_position != 0) {
        if (on_place) on_place(welcome.queue_position);
        return;
    }
    // A live scene may contain edits of others; an exclusive one contains only ours.
    if (join_request.exclusive && welcome.last_sequence < last_answered) {
        throw Error(
            ErrorCode::Unavailable,
            "the master has lost this session's scene (it was restarted, or the connection was lost "
            "for too long): start again; a picture that was finished meanwhile is listed by: tessera jobs");
    }
    joined = welcome;
    const bool again = state == State::Joining && last_sequence > 0;
    state = State::Joined;
    next_id = std::max(next_id, welcome.first_id);
    end_id = welcome.first_id + welcome.id_count;
    if (next_id > end_id) next_id = welcome.first_id;
    if (!again) last_sequence = std::max(last_sequence, welcome.last_sequence);
    // Older ones were answered before the master was lost, but their answers were lost.
    while (unanswered.size() > 1 && unanswered.front().sequence < welcome.last_sequence) {
        results.push_back({.accepted = true,
                           .version = welcome.version,
                           .notes = {"the master was restarted and has this edit; its answer was lost"}});
        unanswered.pop_front();
    }
    resend();
}

void Session::Implementation::take(wire::EditReply&& reply) {
    while (!unanswered.empty() && unanswered.front().sequence <= reply.sequence) {
        results.push_back(reply.result);
        unanswered.pop_front();
    }
    last_answered = std::max(last_answered, reply.sequence);
}

void Session::Implementation::take(wire::FrameHeader&& header) {
    collector.begin(header);
    collect_frame();
}

void Session::Implementation::take(wire::PictureChunk&& chunk) {
    if (auto added = collector.add(std::move(chunk)); !added) throw added.error();
    collect_frame();
}

void Session::Implementation::take(wire::OutputPicture&& picture) {
    auto frame = output_collector.add(std::move(picture));
    if (!frame) throw frame.error();
    if (*frame) output_events.emplace_back(std::move(**frame));
}

// Whether the message was about the progress or end of a view.
bool Session::Implementation::take_for_view(wire::ControlMessage& message) {
    if (const auto* news = std::get_if<wire::ViewProgress>(&message)) {
        if (awaits(news->number)) progress.insert_or_assign(news->number, news->progress);
        return true;
    }
    if (auto* end = std::get_if<wire::ViewDone>(&message)) {
        if (awaits(end->number)) ended_views.insert_or_assign(end->number, std::move(*end));
        return true;
    }
    return false;
}

void Session::Implementation::collect_frame() {
    auto frame = collector.take();
    if (!frame) return;
    const std::uint64_t view = frame->view;
    if (awaits(view)) frames.insert_or_assign(view, std::move(*frame));
}

void Session::Implementation::resend() {
    for (const SentEdit& edit : unanswered) link.send(net::Bytes(edit.encoded.message));
    for (const auto& [request, message] : asked) link.send(message);
    if (asked_status) link.send(*asked_status);
    for (const auto& [number, view] : views) link.send(view);
    for (const std::uint64_t number : stopping) link.send(wire::EndView{.number = number, .deliver = true});
    if (fetched) link.send(*fetched);
    if (!output.empty()) ask_for_output();
}

// ---- requests ----

void Session::Implementation::throw_refusals() {
    if (refusals.empty()) return;
    const std::string reason = std::move(refusals.front());
    refusals.pop_front();
    throw Error(ErrorCode::Refused, "the master refuses: " + reason);
}

void Session::Implementation::send_edit(scene::Edit edit) {
    edit.session = id;
    edit.sequence = ++last_sequence;
    edit.base = scene.version();
    edit.submitted_at = clock.now().time_since_epoch().count();
    unanswered.push_back({last_sequence, encode_edit(std::move(edit), *blobs)});
    if (state == State::Joined) link.send(net::Bytes(unanswered.back().encoded.message));
}

bool Session::Implementation::wait_for_answers(std::size_t at_most, std::stop_token stop) {
    TimePoint last_sign = clock.now();
    std::uint64_t served = link.served_requests();
    while (unanswered.size() > at_most) {
        if (stop.stop_requested()) return false;
        const bool has_come = receive_next(clock.now() + Slice, stop);
        const std::uint64_t served_now = link.served_requests();
        // It sends no other messages while it fetches the blobs of an edit.
        if (has_come || served_now != served) last_sign = clock.now();
        served = served_now;
        throw_refusals();
        if (clock.now() - last_sign > settings.lost_limit) {
            throw Error(ErrorCode::Unavailable, "the master does not answer an edit: is it still running?");
        }
    }
    return true;
}

session::EditResult Session::Implementation::submit(scene::Edit edit) {
    wait_for_answers(0);
    const std::deque<session::EditResult> before = std::exchange(results, {});
    send_edit(std::move(edit));
    wait_for_answers(0);
    session::EditResult result = std::move(results.back());
    results = before;
    return result;
}

}  // namespace tessera::client
