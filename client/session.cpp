#include "client/session.h"

#include <algorithm>
#include <functional>

#include "client/encoded_edit.h"
#include "client/film_collector.h"
#include "client/link.h"
#include "client/picture_collector.h"
#include "client/wire_values.h"
#include "mediator/net/zmq_channel.h"
#include "mediator/wire/envelope.h"

namespace tessera::client {

namespace {

Error lost_session() {
    return Error(
        ErrorCode::Unavailable,
        "the master has lost this session (it was started anew, or the connection was away for too long): "
        "start again");
}

void expect_same(const Rejoined& rejoined) {
    if (!rejoined.same_session) throw lost_session();
}

void throw_refusal(const wire::ControlMessage& message) {
    if (const auto* refusal = std::get_if<wire::Refusal>(&message)) {
        throw Error(ErrorCode::Refused, "the master refuses: " + refusal->reason);
    }
}

}  // namespace

struct Session::Implementation {
    Link link;
    std::shared_ptr<scene::BlobStore> blobs;
    const Clock& clock;
    SessionSettings settings;
    SessionId id;
    std::uint64_t last_sequence = 0, last_job = 0;
    Version version;  // that holds everything submitted so far

    // What has come; nothing when stopped. Looks again now and then, so that a deadline need not be known.
    std::optional<Incoming> next(std::stop_token stop) {
        while (!stop.stop_requested()) {
            if (auto incoming = link.next(clock.now() + std::chrono::seconds(1), stop)) return incoming;
        }
        return std::nullopt;
    }

    // Asks again after a break.
    template <class Answer>
    Answer ask(const wire::ControlMessage& question) {
        link.send(question);
        const TimePoint deadline = clock.now() + settings.lost_limit;
        while (const auto incoming = link.next(deadline, {})) {
            if (std::holds_alternative<Rejoined>(*incoming)) link.send(question);
            const auto* message = std::get_if<wire::ControlMessage>(&*incoming);
            if (message == nullptr) continue;
            throw_refusal(*message);
            if (const auto* answer = std::get_if<Answer>(message)) return *answer;
        }
        throw Error(ErrorCode::Unavailable, "the master does not answer");
    }
};

Session::Session(std::unique_ptr<net::Channel> channel, std::function<void()> reconnect,
                 std::shared_ptr<scene::BlobStore> blobs, const Clock& clock, SessionSettings settings)
    : implementation_(
          new Implementation{.link = Link(std::move(channel), std::move(reconnect), blobs, clock, settings),
                             .blobs = blobs,
                             .clock = clock,
                             .settings = std::move(settings)}) {
    implementation_->id = SessionId{implementation_->link.join()};
}

Session::~Session() = default;

OpenOutcome Session::open_scene(const std::string& title, WhenBusy when_busy,
                                const std::function<void(std::uint32_t)>& on_place, std::stop_token stop) {
    Implementation& self = *implementation_;
    const wire::OpenScene request{.title = title, .no_wait = when_busy == WhenBusy::GiveUp};
    self.link.send(request);
    while (const auto incoming = self.next(stop)) {
        if (std::holds_alternative<Rejoined>(*incoming))
            self.link.send(request);  // harmless when it had arrived
        const auto* message = std::get_if<wire::ControlMessage>(&*incoming);
        if (message == nullptr) continue;
        if (const auto* opened = std::get_if<wire::SceneOpened>(message)) {
            self.version = opened->version;
            return OpenedScene{opened->version, ObjectId{opened->first_id},
                               ObjectId{opened->first_id + opened->id_count}};
        }
        if (const auto* place = std::get_if<wire::QueuePlace>(message); place && on_place)
            on_place(place->place);
        if (const auto* refusal = std::get_if<wire::Refusal>(message);
            refusal && when_busy == WhenBusy::GiveUp) {
            return Busy{refusal->reason};
        }
        throw_refusal(*message);
    }
    return Stopped{};
}

std::optional<SubmitResult> Session::submit(std::vector<scene::Entry> entries, std::stop_token stop) {
    Implementation& self = *implementation_;
    scene::Edit edit{.session = self.id,
                     .sequence = ++self.last_sequence,
                     .base = self.version,
                     .entries = std::move(entries)};
    const EncodedEdit request = encode_edit(std::move(edit), *self.blobs);
    self.link.send(net::Bytes(request.message));
    while (const auto incoming = self.next(stop)) {
        if (const auto* rejoined = std::get_if<Rejoined>(&*incoming)) {
            expect_same(*rejoined);
            self.link.send(net::Bytes(request.message));  // the same sequence again does no harm
        }
        const auto* message = std::get_if<wire::ControlMessage>(&*incoming);
        if (message == nullptr) continue;
        throw_refusal(*message);
        const auto* reply = std::get_if<wire::EditReply>(message);
        if (reply == nullptr || reply->sequence != self.last_sequence) continue;
        if (reply->accepted) self.version = reply->version;
        return SubmitResult{reply->accepted, reply->version, reply->problems};
    }
    return std::nullopt;
}

JobResult Session::render(const JobRequest& request, const std::function<void(const Progress&)>& on_progress,
                          std::stop_token stop) {
    Implementation& self = *implementation_;
    const JobId job{++self.last_job};
    FilmCollector film(job, request.view.window, request.view.channels);
    PictureCollector picture(job);
    const std::stop_callback ask_to_stop(stop, [&] { self.link.send(wire::StopJob{job}); });
    self.link.send(to_wire(request, job));
    if (stop.stop_requested()) self.link.send(wire::StopJob{job});  // after the start, whoever came first

    std::optional<wire::JobDone> done;
    TimePoint last_sign = self.clock.now();
    while (!done || film.count() < done->tiles || picture.byte_size() < done->picture.byte_size) {
        auto incoming = self.link.next(self.clock.now() + std::chrono::seconds(1), {});
        if (!incoming) {
            if (self.clock.now() - last_sign < self.settings.lost_limit) continue;
            throw Error(ErrorCode::Unavailable,
                        done ? "the picture did not arrive in full: start again"
                             : "the master says nothing about the frame any more: start again");
        }
        last_sign = self.clock.now();
        if (const auto* rejoined = std::get_if<Rejoined>(&*incoming)) {
            expect_same(*rejoined);
            if (stop.stop_requested()) self.link.send(wire::StopJob{job});
        } else if (const auto* tile = std::get_if<wire::FrameTile>(&*incoming)) {
            if (auto added = film.add(*tile); !added) throw added.error();
        } else if (auto* chunk = std::get_if<wire::PictureChunk>(&*incoming)) {
            if (auto added = picture.add(std::move(*chunk)); !added) throw added.error();
        } else if (const auto* message = std::get_if<wire::ControlMessage>(&*incoming)) {
            throw_refusal(*message);
            if (const auto* progress = std::get_if<wire::JobProgress>(message);
                progress && progress->job == job) {
                if (on_progress) on_progress(from_wire(*progress));
            } else if (const auto* end = std::get_if<wire::JobDone>(message); end && end->job == job) {
                done = *end;
            }
        }
    }
    JobResult result = from_wire(*done);
    if (done->tiles > 0) result.film = film.take();
    if (result.picture) result.picture->bytes = picture.take();
    return result;
}

ClusterStatus Session::status() {
    return from_wire(implementation_->ask<wire::StatusReply>(wire::StatusRequest{}));
}

wire::Trace Session::trace(std::uint32_t count) {
    return implementation_->ask<wire::Trace>(wire::ReadTrace{.request = 1, .count = count});
}

std::string Session::set_filter(const std::string& filter) {
    const auto reply = implementation_->ask<wire::FilterSet>(wire::SetFilter{filter});
    if (!reply.accepted) throw Error(ErrorCode::Refused, reply.text);
    return reply.text;
}

std::unique_ptr<Session> connect(const Address& address, std::shared_ptr<scene::BlobStore> blobs,
                                 const Clock& clock, const SessionSettings& settings) {
    net::ClientSettings client{.endpoint = address.endpoint, .keys = {}};
    if (!address.keys.empty()) client.keys = net::KeyDirectory(address.keys).client(address.user);
    auto channel = net::make_zmq_client(net::make_zmq_context(), client);
    net::ZmqClient* const sockets = channel.get();  // owned by the session
    return std::make_unique<Session>(
        std::move(channel), [sockets] { sockets->reconnect(); }, std::move(blobs), clock, settings);
}

}  // namespace tessera::client
