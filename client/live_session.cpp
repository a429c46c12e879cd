#include "client/live_session.h"

#include <algorithm>
#include <functional>

#include "client/live_exchange.h"
#include "mediator/net/zmq_channel.h"

namespace tessera::client {

namespace {
constexpr std::size_t MaxAhead = 256;  // edits without an answer
}

LiveSession::LiveSession(std::unique_ptr<net::Channel> channel, std::function<void()> reconnect,
                         std::shared_ptr<scene::BlobStore> blobs, const Clock& clock,
                         SessionSettings settings) {
    settings.returns = true;
    implementation_ = std::make_unique<Implementation>(std::move(channel), std::move(reconnect),
                                                       std::move(blobs), clock, std::move(settings));
    implementation_->id = SessionId{implementation_->link.join()};
}

LiveSession::~LiveSession() = default;

JoinOutcome LiveSession::join(const std::string& title, WhenBusy when_busy,
                              const std::function<void(std::uint32_t)>& on_place, std::stop_token stop) {
    Implementation& self = *implementation_;
    self.join_request = {.title = title,
                         .name = self.settings.name,
                         .key = self.key,
                         .no_wait = when_busy == WhenBusy::GiveUp};
    self.state = Implementation::State::Joining;
    self.link.send(self.join_request);
    while (self.state != Implementation::State::Inside) {
        if (stop.stop_requested()) return Stopped{};
        auto incoming = self.link.next(self.clock.now() + Slice, stop);
        if (!incoming) continue;
        if (const auto* message = std::get_if<wire::ControlMessage>(&*incoming)) {
            if (const auto* place = std::get_if<wire::QueuePlace>(message); place && on_place)
                on_place(place->place);
            if (const auto* refusal = std::get_if<wire::Refusal>(message)) {
                if (when_busy == WhenBusy::GiveUp) return Busy{refusal->reason};
                throw Error(ErrorCode::Refused, "the master refuses: " + refusal->reason);
            }
        }
        std::visit([&](auto&& body) { self.take(std::forward<decltype(body)>(body)); }, *std::move(incoming));
    }
    if (self.settings.mirrors_scene) refresh();
    return Joined{self.joined.title, self.joined.name};
}

void LiveSession::close_scene() {
    implementation_->tell(wire::CloseScene{});
}

const scene::Scene& LiveSession::scene() const {
    return implementation_->scene;
}

void LiveSession::refresh() {
    Implementation& self = *implementation_;
    self.wait_for_answers(0);
    for (int attempt = 0; attempt < 3; ++attempt) {
        const auto content = self.ask<wire::SceneContent>(wire::ReadScene{.known = self.scene.version()});
        scene::ChangeList list = content.list;
        if (!content.blob.empty()) {
            auto decoded = wire::decode_change_list(fetch(content.blob)->bytes());
            if (!decoded) throw decoded.error();
            list = std::move(*decoded);
        }
        if (list.to == self.scene.version() && list.entries.empty()) return;
        if (self.scene.apply(list)) return;
        self.scene = {};  // what we have is of no use: all of it, then
    }
    throw Error(ErrorCode::Internal,
                "the master's scene cannot be mirrored: check that both are one version");
}

ObjectId LiveSession::new_id() {
    Implementation& self = *implementation_;
    if (self.next_id >= self.end_id)
        throw Error(ErrorCode::Refused, "all ids lent to this session are used up: connect anew");
    return ObjectId{self.next_id++};
}

scene::BlobPtr LiveSession::fetch(const scene::BlobRef& blob) {
    Implementation& self = *implementation_;
    if (auto there = self.blobs->find(blob.hash)) return there;
    if (auto wanted = self.fetcher.want(blob); !wanted) throw wanted.error();
    const TimePoint deadline = self.clock.now() + self.settings.lost_limit;
    std::uint64_t received = self.fetcher.received_bytes();
    TimePoint last_sign = self.clock.now();
    while (true) {
        for (const wire::BlobRequest& request : self.fetcher.due(self.clock.now())) self.link.ask(request);
        if (auto there = self.blobs->find(blob.hash)) return there;
        if (!self.fetcher.absent_blobs().empty()) {
            self.fetcher.forget_all();
            throw Error(ErrorCode::NotFound, "the master no longer has blob " + to_hex(blob.hash));
        }
        self.take_in(self.clock.now() + Slice, {});
        self.throw_refusals();
        if (self.fetcher.received_bytes() != received) last_sign = self.clock.now();
        received = self.fetcher.received_bytes();
        if (self.clock.now() > deadline && self.clock.now() - last_sign > self.settings.lost_limit)
            throw Error(ErrorCode::Unavailable, "the master does not send a blob: is it still running?");
    }
}

EditResult LiveSession::submit(std::vector<scene::Entry> entries, std::uint64_t gesture) {
    return implementation_->submit({.entries = std::move(entries), .gesture = gesture});
}

void LiveSession::submit_ahead(std::vector<scene::Entry> entries, std::uint64_t gesture) {
    Implementation& self = *implementation_;
    self.wait_for_answers(MaxAhead - 1);
    self.send_edit({.entries = std::move(entries), .gesture = gesture});
}

std::vector<EditResult> LiveSession::take_results() {
    pump();
    std::deque<EditResult> results = std::exchange(implementation_->results, {});
    return {std::make_move_iterator(results.begin()), std::make_move_iterator(results.end())};
}

void LiveSession::settle() {
    implementation_->wait_for_answers(0);
}

EditResult LiveSession::undo(std::uint64_t transaction) {
    return implementation_->submit({.undo = transaction});
}

void LiveSession::lock(const std::vector<ObjectId>& objects) {
    implementation_->tell(wire::LockObjects{.objects = objects});
}

void LiveSession::unlock(const std::vector<ObjectId>& objects) {
    implementation_->tell(wire::LockObjects{.objects = objects, .release = true});
}

void LiveSession::set_presence(const std::string& text, const std::vector<ObjectId>& selection,
                               Duration time_to_live) {
    implementation_->link.send(wire::SetPresence{text, selection, time_to_live});
}

wire::People LiveSession::people() {
    return implementation_->ask<wire::People>(wire::ReadPeople{});
}

std::vector<wire::TransactionSummary> LiveSession::history(std::uint32_t count) {
    return implementation_->ask<wire::History>(wire::ReadHistory{.count = count}).transactions;
}

std::vector<wire::FieldWriter> LiveSession::writers(ObjectId object) {
    return implementation_->ask<wire::Writers>(wire::ReadWriters{.object = object}).fields;
}

std::vector<wire::EditTrace> LiveSession::trace(std::uint32_t count) {
    return implementation_->ask<wire::Trace>(wire::ReadTrace{.count = count}).edits;
}

void LiveSession::open_view(std::uint64_t number, const LiveViewRequest& request) {
    Implementation& self = *implementation_;
    self.tell(Implementation::opening(number, request, 0));
    self.views.insert_or_assign(number, request);
}

void LiveSession::look(std::uint64_t number, const view::CameraPose& camera) {
    Implementation& self = *implementation_;
    const auto known = self.views.find(number);
    if (known == self.views.end() || known->second.share)
        throw Error(ErrorCode::InvalidInput,
                    "view " + std::to_string(number) + " is not one of this session's own: open it first");
    known->second.view.camera = camera;
    if (self.state == Implementation::State::Inside)
        self.link.send(Implementation::opening(number, known->second, 0));
}

void LiveSession::close_view(std::uint64_t number) {
    Implementation& self = *implementation_;
    self.views.erase(number);
    self.frames.erase(number);
    self.link.send(wire::CloseLiveView{number});
}

std::optional<Frame> LiveSession::next_frame(TimePoint deadline, std::stop_token stop) {
    Implementation& self = *implementation_;
    pump();
    while (self.frames.empty()) {
        self.throw_refusals();
        if (stop.stop_requested() || !self.take_in(deadline, stop)) return std::nullopt;
    }
    Frame frame = std::move(self.frames.extract(self.frames.begin()).mapped());
    self.link.send(wire::FrameTaken{frame.view, frame.number});
    return frame;
}

std::vector<std::string> LiveSession::take_notices() {
    return std::exchange(implementation_->notices, {});
}

wire::Picked LiveSession::pick(std::uint64_t number, std::uint32_t x, std::uint32_t y) {
    auto picked = implementation_->ask<wire::Picked>(wire::Pick{.number = number, .x = x, .y = y});
    if (!picked.problem.empty()) throw Error(ErrorCode::Refused, picked.problem);
    return picked;
}

void LiveSession::pump() {
    Implementation& self = *implementation_;
    while (self.take_in(self.clock.now(), {})) {
    }
    self.throw_refusals();
}

std::unique_ptr<LiveSession> connect_live(const Address& address, std::shared_ptr<scene::BlobStore> blobs,
                                          const Clock& clock, const SessionSettings& settings) {
    net::ClientSettings client{.endpoint = address.endpoint, .keys = {}};
    if (!address.keys.empty()) client.keys = net::KeyDirectory(address.keys).client(address.user);
    auto channel = net::make_zmq_client(net::make_zmq_context(), client);
    net::ZmqClient* const sockets = channel.get();  // owned by the session
    return std::make_unique<LiveSession>(
        std::move(channel), [sockets] { sockets->reconnect(); }, std::move(blobs), clock, settings);
}

}  // namespace tessera::client
