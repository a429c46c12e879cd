#include "client/live_session.h"

#include <algorithm>
#include <deque>
#include <map>
#include <random>

#include "client/frame_collector.h"
#include "client/link.h"
#include "mediator/net/zmq_channel.h"
#include "mediator/wire/blob_transfer.h"
#include "mediator/wire/envelope.h"

namespace tessera::client {

namespace {

constexpr std::size_t MaxAhead = 256;  // edits without an answer
constexpr Duration Slice = std::chrono::milliseconds(200);

std::uint64_t random_key() {
    std::random_device device;
    std::uint64_t key = 0;
    while (key == 0) key = (std::uint64_t{device()} << 32) | device();
    return key;
}

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

struct LiveSession::Implementation {
    struct SentEdit {
        std::uint64_t sequence = 0;
        wire::ControlMessage message;
        scene::BlobPtr encoded;  // kept until the master has it
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
    std::map<std::uint64_t, Frame> frames;  // the newest of each view
    FrameCollector collector;
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

    void take(Rejoined&& rejoined) {
        if (state == State::Outside) return;
        if (rejoined.same_session && state == State::Inside) return resend();
        state = State::Joining;
        join_request.no_wait = false;
        link.send(join_request);
    }

    void take(wire::ControlMessage&& message) {
        if (const auto* welcome = std::get_if<wire::SceneJoined>(&message)) return take(*welcome);
        if (auto* reply = std::get_if<wire::EditReply>(&message)) return take(std::move(*reply));
        if (const auto* refusal = std::get_if<wire::Refusal>(&message)) {
            refusals.push_back(refusal->reason);
            return;
        }
        const std::uint64_t request = request_of(message);
        if (request == 0) {
            // A camera drag that nobody waits for was refused.
            if (const auto* done = std::get_if<wire::RequestDone>(&message)) refusals.push_back(done->text);
            return;
        }
        if (asked.erase(request) > 0) answers.insert_or_assign(request, std::move(message));
    }

    void take(const wire::SceneJoined& welcome) {
        joined = welcome;
        const bool again = state == State::Joining && last_sequence > 0;
        state = State::Inside;
        next_id = std::max(next_id, welcome.first_id);
        end_id = welcome.first_id + welcome.id_count;
        if (next_id > end_id) next_id = welcome.first_id;
        if (!again) last_sequence = std::max(last_sequence, welcome.last_sequence);
        // Older ones were answered before the master was lost, with an answer that was lost with it.
        while (unanswered.size() > 1 && unanswered.front().sequence < welcome.last_sequence) {
            results.push_back(
                {.accepted = true,
                 .version = welcome.version,
                 .notes = {"the master was started anew and has this edit; its answer was lost"}});
            unanswered.pop_front();
        }
        resend();
    }

    void take(wire::EditReply&& reply) {
        while (!unanswered.empty() && unanswered.front().sequence <= reply.sequence) {
            results.push_back(
                {reply.accepted, reply.version, reply.problems, reply.transaction, reply.notes});
            unanswered.pop_front();
        }
    }

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
    void take(wire::BlobChunk&& chunk) { (void)fetcher.receive(std::move(chunk), clock.now()); }
    void take(const wire::BlobAbsent& absent) { fetcher.absent(absent.hash); }

    void frame_may_be_here() {
        if (auto frame = collector.take()) {
            const std::uint64_t view = frame->view;
            frames.insert_or_assign(view, std::move(*frame));
        }
    }

    void resend() {
        for (const SentEdit& edit : unanswered) link.send(edit.message);
        for (const auto& [request, message] : asked) link.send(message);
        for (const auto& [number, request] : views) link.send(opening(number, request, 0));
    }

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

    void throw_refusals() {
        if (refusals.empty()) return;
        const std::string reason = std::move(refusals.front());
        refusals.pop_front();
        throw Error(ErrorCode::Refused, "the master refuses: " + reason);
    }

    void send_edit(scene::Edit edit) {
        edit.session = id;
        edit.sequence = ++last_sequence;
        edit.base = scene.version();
        edit.submitted_at = clock.now().time_since_epoch().count();
        SentEdit sent{.sequence = edit.sequence, .message = wire::SubmitEdit{std::move(edit)}, .encoded = {}};
        if (!wire::fits_control(sent.message)) {
            const scene::Edit& long_edit = std::get<wire::SubmitEdit>(sent.message).edit;
            sent.encoded = blobs->insert(wire::encode(long_edit));
            sent.message =
                wire::SubmitEditByBlob{id, sent.sequence, scene.version(), scene::reference(*sent.encoded)};
        }
        if (state == State::Inside) link.send(sent.message);
        unanswered.push_back(std::move(sent));
    }

    void wait_for_answers(std::size_t at_most) {
        TimePoint last_sign = clock.now();
        while (unanswered.size() > at_most) {
            if (take_in(clock.now() + Slice, {})) last_sign = clock.now();
            throw_refusals();
            if (clock.now() - last_sign > settings.lost_limit) {
                throw Error(ErrorCode::Unavailable,
                            "the master does not answer an edit: is it still running?");
            }
        }
    }

    EditResult submit(scene::Edit edit) {
        wait_for_answers(0);
        const std::deque<EditResult> before = std::exchange(results, {});
        send_edit(std::move(edit));
        wait_for_answers(0);
        EditResult result = std::move(results.back());
        results = before;
        return result;
    }
};

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
    refresh();
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
