#pragma once

#include <algorithm>
#include <deque>
#include <functional>
#include <map>

#include "client/encoded_edit.h"
#include "client/frame_collector.h"
#include "client/link.h"
#include "client/live_session.h"
#include "client/output_collector.h"
#include "mediator/wire/blob_transfer.h"
#include "mediator/wire/envelope.h"

// Private to live_session.cpp and live_exchange.cpp.
namespace tessera::client {

inline constexpr Duration Slice = std::chrono::milliseconds(200);  // of waiting, before looking at limits

std::uint64_t random_key();

// A member's side of the conversation with the master: what was asked and not answered, what has come, and
// how to go on after a break. One thread.
struct LiveSession::Implementation {
    struct SentEdit {
        std::uint64_t sequence = 0;
        EncodedEdit encoded;
    };
    enum class State { Outside, Joining, Inside };

    Link link;
    std::shared_ptr<scene::BlobStore> blobs;
    const Clock& clock;
    SessionSettings settings;
    std::uint64_t key = random_key();
    SessionId id;
    State state = State::Outside;
    wire::JoinScene join_request;
    wire::SceneJoined joined;
    std::uint64_t next_id = 0, end_id = 0;
    scene::Scene scene;
    std::uint64_t last_sequence = 0, last_request = 0;
    std::deque<SentEdit> unanswered;
    std::deque<EditResult> results;
    std::map<std::uint64_t, wire::ControlMessage> asked, answers;  // by request
    std::map<std::uint64_t, LiveViewRequest> views;
    std::deque<std::string> refusals;
    std::vector<std::string> notices;
    std::map<std::uint64_t, Frame> frames;  // the newest of each view
    FrameCollector collector;
    std::string output;                // shown by this session; "" = none
    std::uint64_t output_request = 0;  // the latest question for it
    OutputCollector output_collector;
    std::deque<OutputEvent> output_events;
    wire::BlobFetcher fetcher;

    Implementation(std::unique_ptr<net::Channel> channel, std::function<void()> reconnect,
                   std::shared_ptr<scene::BlobStore> store, const Clock& time, SessionSettings how)
        : link(std::move(channel), std::move(reconnect), store, time, how),
          blobs(store),
          clock(time),
          settings(std::move(how)),
          fetcher(store, wire::BlobLimits{}) {}

    // ---- what has come ----

    // False: nothing came until the deadline.
    bool take_in(TimePoint deadline, std::stop_token stop) {
        auto incoming = link.next(deadline, stop);
        if (!incoming) return false;
        std::visit([this](auto&& body) { take(std::forward<decltype(body)>(body)); }, *std::move(incoming));
        return true;
    }

    void take(Rejoined&& rejoined);

    void take(wire::ControlMessage&& message);

    void take(const wire::SceneJoined& welcome);

    void take(wire::EditReply&& reply);

    void take(wire::LiveFrame&& header) {
        collector.begin(header);
        frame_may_be_here();
    }
    void take(wire::PictureChunk&& chunk) {
        if (auto added = collector.add(std::move(chunk)); !added) throw added.error();
        frame_may_be_here();
    }
    void take(wire::FrameTile&& tile) {
        if (auto added = collector.add(std::move(tile)); !added) throw added.error();
        frame_may_be_here();
    }
    void take(wire::OutputPicture&& picture) {
        auto frame = output_collector.add(std::move(picture));
        if (!frame) throw frame.error();
        if (*frame) output_events.emplace_back(std::move(**frame));
    }
    bool take_for_output(wire::ControlMessage& message);
    void ask_for_output();
    void take(wire::BlobChunk&& chunk) { (void)fetcher.receive(std::move(chunk), clock.now()); }
    void take(const wire::BlobAbsent& absent) { fetcher.absent(absent.hash); }

    void frame_may_be_here();

    void resend();

    // ---- asking ----

    static wire::OpenLiveView opening(std::uint64_t number, const LiveViewRequest& request,
                                      std::uint64_t asking) {
        return {.request = asking,
                .number = number,
                .name = request.name,
                .view = request.view,
                .spp = request.spp,
                .picture = request.picture,
                .film = request.film,
                .share = request.share};
    }

    template <class Answer, class Question>
    Answer ask(Question question) {
        const std::uint64_t request = ++last_request;
        question.request = request;
        asked.emplace(request, question);
        link.send(std::move(question));
        const TimePoint deadline = clock.now() + settings.lost_limit;
        while (!answers.contains(request)) {
            take_in(std::min(clock.now() + Slice, deadline), {});
            throw_refusals();
            if (clock.now() >= deadline) {
                asked.erase(request);
                throw Error(ErrorCode::Unavailable, "the master does not answer: is it still running?");
            }
        }
        const wire::ControlMessage message = std::move(answers.extract(request).mapped());
        if (const auto* answer = std::get_if<Answer>(&message)) return *answer;
        const auto* done = std::get_if<wire::RequestDone>(&message);
        throw Error(ErrorCode::Refused,
                    done ? done->text : "the master gave another answer than was asked for");
    }

    template <class Question>
    void tell(Question question) {
        const auto done = ask<wire::RequestDone>(std::move(question));
        if (!done.accepted) throw Error(ErrorCode::Refused, done.text);
    }

    void throw_refusals();

    void send_edit(scene::Edit edit);

    void wait_for_answers(std::size_t at_most);

    EditResult submit(scene::Edit edit);
};

}  // namespace tessera::client
