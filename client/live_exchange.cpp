#include "client/live_exchange.h"

#include <random>

namespace tessera::client {

namespace {

// The request's number where a message answers one; 0 where it does not.
std::uint64_t request_of(const wire::ControlMessage& message) {
    return std::visit(
        [](const auto& body) -> std::uint64_t {
            if constexpr (requires { body.request; }) return body.request;
            return 0;
        },
        message);
}

}  // namespace

std::uint64_t random_key() {
    std::random_device device;
    std::uint64_t key = 0;
    while (key == 0) key = (std::uint64_t{device()} << 32) | device();
    return key;
}

void LiveSession::Implementation::take(Rejoined&& rejoined) {
    if (state == State::Outside) return;
    if (rejoined.same_session && state == State::Inside) return resend();
    state = State::Joining;
    join_request.no_wait = false;
    link.send(join_request);
}

void LiveSession::Implementation::take(wire::ControlMessage&& message) {
    if (const auto* welcome = std::get_if<wire::SceneJoined>(&message)) return take(*welcome);
    // Whatever went out between the new greeting and the new joining was refused; it is sent again.
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
    if (take_for_output(message)) return;
    const std::uint64_t request = request_of(message);
    if (request == 0) {
        // A camera drag that nobody waits for was refused.
        if (const auto* done = std::get_if<wire::RequestDone>(&message)) refusals.push_back(done->text);
        return;
    }
    if (asked.erase(request) > 0) answers.insert_or_assign(request, std::move(message));
}

void LiveSession::Implementation::take(const wire::SceneJoined& welcome) {
    joined = welcome;
    const bool again = state == State::Joining && last_sequence > 0;
    state = State::Inside;
    next_id = std::max(next_id, welcome.first_id);
    end_id = welcome.first_id + welcome.id_count;
    if (next_id > end_id) next_id = welcome.first_id;
    if (!again) last_sequence = std::max(last_sequence, welcome.last_sequence);
    // Older ones were answered before the master was lost, with an answer that was lost with it.
    while (unanswered.size() > 1 && unanswered.front().sequence < welcome.last_sequence) {
        results.push_back({.accepted = true,
                           .version = welcome.version,
                           .notes = {"the master was started anew and has this edit; its answer was lost"}});
        unanswered.pop_front();
    }
    resend();
}

void LiveSession::Implementation::take(wire::EditReply&& reply) {
    while (!unanswered.empty() && unanswered.front().sequence <= reply.sequence) {
        results.push_back({reply.accepted, reply.version, reply.problems, reply.transaction, reply.notes});
        unanswered.pop_front();
    }
}

void LiveSession::Implementation::frame_may_be_here() {
    if (auto frame = collector.take()) {
        const std::uint64_t view = frame->view;
        frames.insert_or_assign(view, std::move(*frame));
    }
}

void LiveSession::Implementation::resend() {
    for (const SentEdit& edit : unanswered) link.send(net::Bytes(edit.encoded.message));
    for (const auto& [request, message] : asked) link.send(message);
    for (const auto& [number, request] : views) link.send(opening(number, request, 0));
    if (!output.empty()) ask_for_output();
}

void LiveSession::Implementation::throw_refusals() {
    if (refusals.empty()) return;
    const std::string reason = std::move(refusals.front());
    refusals.pop_front();
    throw Error(ErrorCode::Refused, "the master refuses: " + reason);
}

void LiveSession::Implementation::send_edit(scene::Edit edit) {
    edit.session = id;
    edit.sequence = ++last_sequence;
    edit.base = scene.version();
    edit.submitted_at = clock.now().time_since_epoch().count();
    unanswered.push_back({last_sequence, encode_edit(std::move(edit), *blobs)});
    if (state == State::Inside) link.send(net::Bytes(unanswered.back().encoded.message));
}

void LiveSession::Implementation::wait_for_answers(std::size_t at_most) {
    TimePoint last_sign = clock.now();
    while (unanswered.size() > at_most) {
        if (take_in(clock.now() + Slice, {})) last_sign = clock.now();
        throw_refusals();
        if (clock.now() - last_sign > settings.lost_limit) {
            throw Error(ErrorCode::Unavailable, "the master does not answer an edit: is it still running?");
        }
    }
}

EditResult LiveSession::Implementation::submit(scene::Edit edit) {
    wait_for_answers(0);
    const std::deque<EditResult> before = std::exchange(results, {});
    send_edit(std::move(edit));
    wait_for_answers(0);
    EditResult result = std::move(results.back());
    results = before;
    return result;
}

}  // namespace tessera::client
