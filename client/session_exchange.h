#pragma once

#include <algorithm>
#include <deque>
#include <functional>
#include <map>
#include <set>

#include "client/encoded_edit.h"
#include "client/frame_collector.h"
#include "client/link.h"
#include "client/output_collector.h"
#include "client/session.h"
#include "mediator/wire/blob_transfer.h"
#include "mediator/wire/envelope.h"

// Private to session*.cpp.
namespace tessera::client {

inline constexpr Duration Slice =
    std::chrono::milliseconds(200);  // how long to wait before checking timeouts
// For a master that does not answer, after an interrupt.
inline constexpr Duration InterruptedWait = std::chrono::milliseconds(500);

// The client's protocol state: unanswered requests, received messages, and recovery after a lost connection.
// Not thread-safe.
struct Session::Implementation {
    struct SentEdit {
        std::uint64_t sequence = 0;
        EncodedEdit encoded;
    };
    enum class State { NotJoined, Joining, Joined };

    Link link;
    std::shared_ptr<scene::BlobStore> blobs;
    const Clock& clock;
    SessionSettings settings;
    SessionId id;
    State state = State::NotJoined;
    wire::JoinScene join_request;
    std::function<void(std::uint32_t)> on_place;
    wire::SceneJoined joined;
    std::uint64_t next_id = 0, end_id = 0;
    scene::Scene scene;
    std::uint64_t last_sequence = 0, last_answered = 0, last_request = 0;
    std::deque<SentEdit> unanswered;
    std::deque<session::EditResult> results;
    std::map<std::uint64_t, wire::ControlMessage> asked, answers;  // by request
    std::optional<wire::StatusRequest> asked_status;
    std::optional<wire::StatusReply> status;
    wire::StatusReply status_page(NodeId after);
    std::map<std::uint64_t, wire::RequestView> views;  // the latest request of each
    std::map<std::uint64_t, scene::BlobPtr> films;     // that they continue: for a master that asks again
    std::optional<wire::FetchJob> fetched;             // the job being fetched
    std::set<std::uint64_t> stopping;                  // views that were asked to end
    std::map<std::uint64_t, session::ViewProgress> progress;
    std::map<std::uint64_t, wire::ViewDone> ended_views;
    std::deque<std::string> refusals;
    std::vector<std::string> notices;
    std::map<std::uint64_t, Frame> frames;  // the newest of each view
    FrameCollector collector;
    std::string output;                // shown by this session; "" = none
    std::uint64_t output_request = 0;  // request number of the latest JoinOutput
    OutputCollector output_collector;
    std::deque<OutputEvent> output_events;
    wire::BlobFetcher fetcher;
    std::optional<TimePoint> interrupted_at;

    Implementation(std::unique_ptr<net::Channel> channel, std::function<void()> reconnect,
                   std::shared_ptr<scene::BlobStore> store, const Clock& time, SessionSettings how);

    // ---- received messages ----

    // All waits go through it. False: no message until the deadline. Throws Error{Unavailable} after an interrupt if the
    // master is silent.
    bool receive_next(TimePoint deadline, std::stop_token stop);
    void take(Interrupted&&) const { notify_away(true); }
    void take(Rejoined&& rejoined);
    void take(wire::ControlMessage&& message);
    void take(const wire::SceneJoined& welcome);
    void take(wire::EditReply&& reply);
    void take(wire::FrameHeader&& header);
    void take(wire::PictureChunk&& chunk);
    void take(wire::FrameTile&& tile) { take_film(std::move(tile)); }
    void take(wire::FilmBlock&& block) { take_film(std::move(block)); }
    template <class Part>
    void take_film(Part&& part) {
        if (auto added = collector.add(std::forward<Part>(part)); !added) throw added.error();
        collect_frame();
    }
    void take(wire::OutputPicture&& picture);
    void take(wire::BlobChunk&& chunk) { (void)fetcher.receive(std::move(chunk), clock.now()); }
    void take(const wire::BlobAbsent& absent) { fetcher.absent(absent.hash); }
    bool take_for_view(wire::ControlMessage& message);
    bool take_for_output(wire::ControlMessage& message);
    void notify_away(bool is_away) const {
        if (settings.on_away) settings.on_away(is_away);
    }
    void collect_frame();
    void resend();

    // ---- requests ----

    template <class Answer, class Question>
    Answer ask(Question question) {
        const std::uint64_t request = ++last_request;
        question.request = request;
        asked.emplace(request, question);
        link.send(std::move(question));
        TimePoint deadline = clock.now() + settings.lost_limit;
        std::uint64_t served = link.served_requests();
        while (!answers.contains(request)) {
            receive_next(std::min(clock.now() + Slice, deadline), {});
            throw_refusals();
            // It does not answer while it fetches the blobs that the question needs.
            if (served != link.served_requests()) deadline = clock.now() + settings.lost_limit;
            served = link.served_requests();
            if (clock.now() >= deadline) {
                asked.erase(request);
                throw Error(ErrorCode::Unavailable, "the master does not answer: is it still running?");
            }
        }
        const wire::ControlMessage message = std::move(answers.extract(request).mapped());
        if (const auto* answer = std::get_if<Answer>(&message)) return *answer;
        const auto* done = std::get_if<wire::RequestDone>(&message);
        throw Error(
            ErrorCode::Refused,
            done ? done->text
                 : "the master sent an unexpected answer: check that master and client are of the same "
                   "version");
    }

    // Returns the master's description of the effect; throws Error{Refused} if it rejects the request, and
    // Error{Unavailable} if its machine lacks what the request needs.
    template <class Question>
    std::string send_and_confirm(Question question) {
        const auto done = ask<wire::RequestDone>(std::move(question));
        if (done.unavailable) throw Error(ErrorCode::Unavailable, done.text);
        if (!done.accepted) throw Error(ErrorCode::Refused, done.text);
        return done.text;
    }

    void throw_refusals();
    void send_edit(scene::Edit edit);
    bool wait_for_answers(std::size_t at_most, std::stop_token stop = {});  // false: stopped before
    session::EditResult submit(scene::Edit edit);
    void ask_for_output();
    void request(std::uint64_t number, wire::RequestView&& request);
    void forget_view(std::uint64_t number);
    bool awaits(std::uint64_t number) const {
        return views.contains(number) || (fetched && fetched->number == number);
    }
};

}  // namespace tessera::client
