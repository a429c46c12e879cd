#include "client/session.h"

#include <algorithm>
#include <iterator>

#include "client/channel_session.h"
#include "client/session_exchange.h"
#include "mediator/net/zmq_channel.h"

namespace tessera::client {

namespace {
constexpr std::size_t MaxAhead = 256;  // unanswered edits
}

Session::Session(std::unique_ptr<Implementation> implementation)
    : implementation_(std::move(implementation)) {}

Session::~Session() = default;

JoinOutcome Session::join(const JoinRequest& request, std::stop_token stop) {
    Implementation& self = *implementation_;
    const bool gives_up = request.when_busy == WhenBusy::GiveUp;
    self.join_request.title = request.title;
    self.join_request.name = self.settings.name;
    self.join_request.no_wait = gives_up;
    self.join_request.exclusive = request.exclusive;
    self.on_place = request.on_place;
    self.state = Implementation::State::Joining;
    self.link.send(self.join_request);
    while (self.state != Implementation::State::Joined) {
        if (stop.stop_requested()) {
            self.state = Implementation::State::NotJoined;
            return Stopped{};
        }
        auto incoming = self.link.next(self.clock.now() + Slice, stop);
        if (!incoming) continue;
        const auto* message = std::get_if<wire::ControlMessage>(&*incoming);
        if (const auto* refusal = message ? std::get_if<wire::Refusal>(message) : nullptr) {
            self.state = Implementation::State::NotJoined;
            if (gives_up) return Busy{refusal->reason};
            throw Error(ErrorCode::Refused, "the master refuses: " + refusal->reason);
        }
        std::visit([&](auto&& content) { self.take(std::forward<decltype(content)>(content)); },
                   *std::move(incoming));
    }
    if (self.settings.mirrors_scene && !request.exclusive) refresh();
    const wire::SceneJoined& joined = self.joined;
    return Joined{joined.title, joined.name, joined.version, ObjectId{joined.first_id},
                  ObjectId{joined.first_id + joined.id_count}};
}

void Session::close_scene() {
    implementation_->send_and_confirm(wire::CloseScene{});
}

const scene::Scene& Session::scene() const {
    return implementation_->scene;
}

void Session::refresh() {
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
        self.scene = {};  // discard the mirror and fetch the whole scene
    }
    throw Error(
        ErrorCode::Internal,
        "the master's scene cannot be mirrored: check that master and client are of the same version");
}

ObjectId Session::new_id() {
    Implementation& self = *implementation_;
    if (self.next_id >= self.end_id)
        throw Error(ErrorCode::Refused, "all object ids allocated to this session are used: reconnect");
    return ObjectId{self.next_id++};
}

scene::BlobPtr Session::fetch(const scene::BlobRef& blob) {
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
        self.receive_next(self.clock.now() + Slice, {});
        self.throw_refusals();
        if (self.fetcher.received_bytes() != received) last_sign = self.clock.now();
        received = self.fetcher.received_bytes();
        if (self.clock.now() > deadline && self.clock.now() - last_sign > self.settings.lost_limit)
            throw Error(ErrorCode::Unavailable, "the master does not send a blob: is it still running?");
    }
}

session::EditResult Session::submit(std::vector<scene::Entry> entries, std::uint64_t edit_group) {
    return implementation_->submit({.entries = std::move(entries), .edit_group = edit_group});
}

void Session::submit_ahead(std::vector<scene::Entry> entries, std::uint64_t edit_group) {
    Implementation& self = *implementation_;
    self.wait_for_answers(MaxAhead - 1);
    self.send_edit({.entries = std::move(entries), .edit_group = edit_group});
}

std::vector<session::EditResult> Session::take_results() {
    pump();
    std::deque<session::EditResult> results = std::exchange(implementation_->results, {});
    return {std::make_move_iterator(results.begin()), std::make_move_iterator(results.end())};
}

bool Session::settle(std::stop_token stop) {
    return implementation_->wait_for_answers(0, stop);
}

session::EditResult Session::undo(std::uint64_t transaction) {
    return implementation_->submit({.undo = transaction});
}

void Session::lock(const std::vector<ObjectId>& objects) {
    implementation_->send_and_confirm(wire::LockObjects{.objects = objects});
}

void Session::unlock(const std::vector<ObjectId>& objects) {
    implementation_->send_and_confirm(wire::LockObjects{.objects = objects, .release = true});
}

void Session::set_presence(const std::string& text, const std::vector<ObjectId>& selection,
                           Duration time_to_live) {
    implementation_->link.send(wire::SetPresence{text, selection, time_to_live});
}

session::Members Session::members() {
    return implementation_->ask<wire::Members>(wire::ReadMembers{}).content;
}

std::vector<session::TransactionSummary> Session::history(std::uint32_t count) {
    return implementation_->ask<wire::History>(wire::ReadHistory{.count = count}).transactions;
}

std::vector<session::FieldWriter> Session::writers(ObjectId object) {
    return implementation_->ask<wire::Writers>(wire::ReadWriters{.object = object}).fields;
}

std::vector<session::EditTrace> Session::trace(std::uint32_t count) {
    return implementation_->ask<wire::Trace>(wire::ReadTrace{.count = count}).edits;
}

session::ClusterStatus Session::status() {
    wire::StatusReply page = implementation_->status_page({});
    session::ClusterStatus status = std::move(page.status);
    while (page.more && !status.nodes.empty()) {
        page = implementation_->status_page(status.nodes.back().summary.id);
        std::move(page.status.nodes.begin(), page.status.nodes.end(), std::back_inserter(status.nodes));
        if (page.status.nodes.empty()) break;
    }
    return status;
}

wire::StatusReply Session::Implementation::status_page(NodeId after) {
    status.reset();
    asked_status = wire::StatusRequest{after};
    link.send(*asked_status);
    const TimePoint deadline = clock.now() + settings.lost_limit;
    while (!status && clock.now() < deadline) {
        receive_next(std::min(clock.now() + Slice, deadline), {});
        throw_refusals();
    }
    asked_status.reset();
    if (!status) throw Error(ErrorCode::Unavailable, "the master does not answer: is it still running?");
    return *std::move(status);
}

void Session::pump() {
    Implementation& self = *implementation_;
    while (self.receive_next(self.clock.now(), {})) {
    }
    self.throw_refusals();
}

std::unique_ptr<Session> make_session(std::unique_ptr<net::Channel> channel, std::function<void()> reconnect,
                                      std::shared_ptr<scene::BlobStore> blobs, const Clock& clock,
                                      SessionSettings settings) {
    return std::make_unique<Session>(std::make_unique<Session::Implementation>(
        std::move(channel), std::move(reconnect), std::move(blobs), clock, std::move(settings)));
}

std::unique_ptr<Session> connect(const Address& address, std::shared_ptr<scene::BlobStore> blobs,
                                 const Clock& clock, const SessionSettings& settings) {
    net::ClientSettings client{.endpoint = address.endpoint, .keys = {}};
    if (!address.keys.empty()) client.keys = net::KeyDirectory(address.keys).client(address.user);
    auto channel = net::make_zmq_client(net::make_zmq_context(), client);
    net::ZmqClient* const sockets = channel.get();  // owned by the session
    return make_session(
        std::move(channel), [sockets] { sockets->reconnect(); }, std::move(blobs), clock, settings);
}

}  // namespace tessera::client
