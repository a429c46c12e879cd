#include "tests/fuzz/random_peer.h"

#include <algorithm>
#include <map>

#include "mediator/frame/render_revision.h"
#include "mediator/view/view.h"
#include "mediator/wire/envelope.h"
#include "mediator/wire/film_state_codec.h"
#include "tests/wire/described_values.h"

namespace tessera::test {

namespace {

bool may_send(net::Role role, wire::Senders senders) {
    const bool editor = role == net::Role::Editor || role == net::Role::Operator;
    switch (senders) {
        case wire::Senders::Master:
            return false;
        case wire::Senders::Nodes:
            return role == net::Role::Node;
        case wire::Senders::Editors:
            return editor;
        case wire::Senders::Operators:
            return role == net::Role::Operator;
        case wire::Senders::Clients:
            return editor || role == net::Role::Viewer;
        case wire::Senders::Everyone:
            return true;
    }
    return false;
}

// What a role may send; members of the scene of an honest editor do not close it.
struct Kinds {
    std::vector<std::string_view> names;
    std::vector<std::variant<wire::ControlMessage, wire::BulkMessage>> messages;
    Kinds(net::Role role, bool is_member) {
        const auto add = [&](const auto& message, std::string_view name, wire::Senders senders) {
            if (!may_send(role, senders)) return;
            names.push_back(name);
            messages.emplace_back(message);
        };
        wire::table::Control::for_each([&](const wire::ControlMessage& message, std::string_view name) {
            if (is_member && std::holds_alternative<wire::CloseScene>(message)) return;
            add(message, name, wire::table::Control::senders(message));
        });
        wire::table::Bulk::for_each([&](const wire::BulkMessage& message, std::string_view name) {
            add(message, name, wire::table::Bulk::senders(message));
        });
    }
    static const Kinds& of(net::Role role, bool is_member) {
        static std::map<std::pair<net::Role, bool>, Kinds> known;
        return known.try_emplace({role, is_member}, role, is_member).first->second;
    }
};

template <class... Kind>
bool is_any_of(const auto& value) {
    return (std::holds_alternative<Kind>(value) || ...);
}

// A viewer may see cameras and where they are; docs/security.md keeps all other objects from it.
bool has_secrets(const scene::ChangeList& list) {
    return std::ranges::any_of(list.entries, [](const scene::Entry& entry) {
        return std::visit(
            [](const auto& each) {
                if constexpr (requires { each.object; }) {
                    return !is_any_of<scene::Root, scene::Transform, scene::Camera>(each.object);
                } else {
                    return false;
                }
            },
            entry);
    });
}

}  // namespace

Reached& Reached::operator+=(const Reached& other) {
    edits += other.edits;
    requests += other.requests;
    frames += other.frames;
    units += other.units;
    return *this;
}

RandomPeer::RandomPeer(std::unique_ptr<net::Channel> channel, const Settings& settings, Traffic& traffic,
                       std::uint64_t& highest_unit, std::uint64_t seed)
    : channel_(std::move(channel)),
      settings_(settings),
      traffic_(traffic),
      random_(seed),
      edits_(random_, settings.spared),
      film_(random_, highest_unit) {
    greet();
}

std::set<std::string_view> RandomPeer::kinds(std::span<const net::Role> roles) {
    std::set<std::string_view> names;
    for (const net::Role role : roles) {
        const Kinds& kinds = Kinds::of(role, false);
        names.insert(kinds.names.begin(), kinds.names.end());
    }
    return names;
}

bool RandomPeer::send(const wire::ControlMessage& message) {
    if (channel_->send(net::Link::Control, net::ServerPeer, wire::encode(message)) != net::SendResult::Sent)
        return false;
    traffic_.sent(wire::table::Control::name(message));
    ++sent_;
    return true;
}

bool RandomPeer::send(const wire::BulkMessage& message) {
    if (channel_->send(net::Link::Bulk, net::ServerPeer, wire::encode(message)) != net::SendResult::Sent)
        return false;
    traffic_.sent(wire::table::Bulk::name(message));
    ++sent_;
    return true;
}

void RandomPeer::greet() {
    wire::Hello hello{
        .peer = settings_.role == net::Role::Node ? wire::PeerKind::Node : wire::PeerKind::Client,
        .name = random_.name(settings_.name)};
    hello.backend = "null";
    hello.kind = frame::with_render_revision("null-1");
    hello.channels = frame::ChannelSet::all();
    hello.concurrent_units = 1 + static_cast<std::uint32_t>(random_.below(wire::MaxConcurrentUnits));
    hello.resume_token = random_.chance(50) ? token_ : 0;
    greeted_ = send(hello);
}

void RandomPeer::say_goodbye() {
    (void)send(wire::Goodbye{.reason = "done", .units_sent = {}});
    channel_->close();
}

void RandomPeer::take(const wire::ControlMessage& message) {
    if (settings_.role == net::Role::Viewer &&
        is_any_of<wire::Changes, wire::ChangesByBlob, wire::History, wire::Writers, wire::Trace>(message))
        leak_ = wire::table::Control::name(message);
    if (const auto* welcome = std::get_if<wire::Welcome>(&message)) {
        token_ = welcome->token;
        edits_.renewed(welcome->epoch);
        welcome_ = true;
        (void)send(wire::BulkHello{token_});
    } else if (std::holds_alternative<wire::Unknown>(message)) {
        welcome_ = joined_ = false;
        greet();
    } else if (const auto* joined = std::get_if<wire::SceneJoined>(&message)) {
        if (joined->queue_position != 0) return;
        joined_ = true;
        edits_.joined(*joined);
    } else if (const auto* reply = std::get_if<wire::EditReply>(&message)) {
        edits_.answered(*reply);
    } else if (const auto* done = std::get_if<wire::RequestDone>(&message)) {
        requests_ += done->accepted ? 1 : 0;
    } else if (const auto* content = std::get_if<wire::SceneContent>(&message)) {
        if (!content->blob.empty()) blobs_.push_back(content->blob.hash);
        if (settings_.role == net::Role::Viewer && has_secrets(content->list)) leak_ = "objects";
    } else if (const auto* changes = std::get_if<wire::ChangesByBlob>(&message)) {
        blobs_.push_back(changes->blob.hash);
        edits_.learned(changes->to);
    } else if (const auto* list = std::get_if<wire::Changes>(&message)) {
        edits_.learned(list->list.to, list->list.state_hash);
        if (settings_.role == net::Role::Node && random_.chance(80)) ask_for_work();
    } else if (const auto* work = std::get_if<wire::Work>(&message)) {
        film_.add(work->unit);
    } else if (const auto* view = std::get_if<wire::OpenView>(&message)) {
        film_.add(*view);
    }
    if (blobs_.size() > 16) blobs_.pop_front();
}

// As a node that has built the version.
void RandomPeer::ask_for_work() {
    wire::VersionReport report;
    report.version = edits_.version();
    report.state_hash = edits_.state_hash();
    (void)send(report);
    wire::Heartbeat heartbeat;
    heartbeat.version = edits_.version();
    heartbeat.free_slots = 1 + static_cast<std::uint32_t>(random_.below(4));
    (void)send(heartbeat);
}

void RandomPeer::take(const wire::BulkMessage& message) {
    if (std::holds_alternative<wire::FrameHeader>(message)) ++frames_;
    const auto* chunk = std::get_if<wire::BlobChunk>(&message);
    if (settings_.role == net::Role::Viewer && chunk != nullptr && chunk->data.size() == chunk->total) {
        const auto list = wire::decode_change_list(chunk->data);
        if (!list || has_secrets(*list)) leak_ = "a blob with more than cameras";
    }
    const auto* request = std::get_if<wire::BlobRequest>(&message);
    if (request == nullptr || random_.chance(10)) return;
    const auto offered = std::ranges::find(offered_, request->hash, &Offered::hash);
    if (offered == offered_.end() || request->offset >= offered->bytes.size()) return;
    const auto first = offered->bytes.begin() + static_cast<std::ptrdiff_t>(request->offset);
    const std::size_t size = std::min<std::size_t>(wire::MaxChunk, offered->bytes.size() - request->offset);
    (void)send(wire::BlobChunk{.hash = offered->hash,
                               .total = offered->bytes.size(),
                               .offset = request->offset,
                               .data = {first, first + static_cast<std::ptrdiff_t>(size)}});
}

void RandomPeer::read() {
    while (true) {
        net::Received received = channel_->receive(TimePoint{});
        const auto* message = std::get_if<net::Message>(&received);
        if (message == nullptr) return;
        if (message->link == net::Link::Bulk) {
            if (const auto bulk = wire::decode_bulk(message->bytes)) take(*bulk);
        } else if (const auto decoded = wire::decode_control(message->bytes)) {
            take(*decoded);
        }
    }
}

bool RandomPeer::act() {
    read();
    if (!greeted_) greet();
    if (settings_.joins && welcome_ && !joined_ && settings_.role != net::Role::Node && random_.chance(30)) {
        return send(wire::JoinScene{.title = "of " + settings_.name,
                                    .name = random_.name(settings_.name),
                                    .key = settings_.role == net::Role::Viewer ? 0 : 1 + random_.below(3)});
    }
    if (random_.chance(50)) return send_rarest();
    if (settings_.role == net::Role::Node) {
        if (random_.chance(settings_.may_forge ? 20 : 60)) return send_filled(wire::UnitReleased{});
        if (random_.chance(60))
            return send(wire::BulkMessage(film_.film(edits_.version(), settings_.may_forge)));
        return random_.chance(50) ? send_filled(wire::Heartbeat{}) : send_filled(wire::VersionReport{});
    }
    if (joined_ && may_send(settings_.role, wire::Senders::Editors) && random_.chance(70)) return send_edit();
    return random_.chance(50) ? send_filled(wire::RequestView{}) : send_rarest();
}

bool RandomPeer::send_rarest() {
    const Kinds& kinds = Kinds::of(settings_.role, settings_.joins);
    const auto& chosen = kinds.messages[traffic_.rarest(kinds.names)];
    if (const auto* control = std::get_if<wire::ControlMessage>(&chosen)) return send_filled(*control);
    return send(filled(std::get<wire::BulkMessage>(chosen)));
}

bool RandomPeer::send_filled(wire::ControlMessage message) {
    if (std::holds_alternative<wire::SubmitEdit>(message)) return send_edit();
    std::visit([&](auto& each) { adjust(each); }, message);
    const std::vector<std::byte> bytes = wire::encode(message);
    if (!wire::fits_control(bytes)) return true;  // no client would send it
    if (is_any_of<wire::Goodbye>(message)) joined_ = welcome_ = greeted_ = false;
    if (is_any_of<wire::Hello>(message)) joined_ = welcome_ = false;
    return send(message);
}

bool RandomPeer::send_edit() {
    if (random_.below(1500) == 0) {
        EditGenerator::Encoded encoded = edits_.long_edit();
        return offer(std::move(encoded.head), std::move(encoded.bytes));
    }
    const scene::Edit edit = edits_.edit();
    wire::ControlMessage message = wire::SubmitEdit{edit};
    if (wire::may_fit_control(edit.entries.size())) {
        if (wire::fits_control(wire::encode(message))) return send(message);
    }
    return offer({.session = {}, .sequence = edit.sequence, .base = edit.base, .blob = {}},
                 wire::encode(edit));
}

bool RandomPeer::offer(wire::SubmitEditByBlob&& edit, std::vector<std::byte>&& bytes) {
    edit.blob = {.hash = blake2b(bytes), .byte_size = bytes.size()};
    offered_.push_back({edit.blob.hash, std::move(bytes)});
    if (offered_.size() > 1) offered_.pop_front();
    return send(wire::ControlMessage(std::move(edit)));
}

void RandomPeer::adjust_view(session::ViewRequest& wanted) {
    session::ViewRequest request{
        .stop = {.spp = random_.chance(80) ? 1 + random_.below(64) : random_.extreme()}};
    const auto side = [&] {
        return static_cast<std::uint32_t>(random_.chance(95) ? 1 + random_.below(200) : random_.extreme());
    };
    request.view.width = side();
    request.view.height = side();
    request.view.window = {0, 0, static_cast<std::int32_t>(request.view.width),
                           static_cast<std::int32_t>(request.view.height)};
    if (random_.chance(10)) request.view.window = wanted.view.window;
    request.view.camera =
        random_.chance(70) ? view::perspective(glm::dmat4(1.0), 0.8, 1.0) : wanted.view.camera;
    request.view.channels =
        random_.chance(70) ? frame::ChannelSet{frame::Channel::Radiance} : wanted.view.channels;
    request.view.filter = random_.chance(50) ? "" : random_.chance(50) ? "gauss" : wanted.view.filter;
    request.picture = wanted.picture;
    request.frames = wanted.frames;
    request.film = wanted.film;
    request.min_nodes = random_.chance(90) ? 0 : wanted.min_nodes;
    request.wait_limit = wanted.wait_limit;
    if (random_.chance(20)) request.stop = wanted.stop;
    request.name = random_.chance(70) ? "" : random_.name(view_name());
    request.detached = random_.chance(20) && !request.name.empty();
    wanted = std::move(request);
}

// Film of the first tile of the view, as a blob; sometimes of another scene, or damaged.
wire::EarlierFilm RandomPeer::earlier_film(const session::ViewRequest& wanted) {
    constexpr std::int32_t Edge = 32;
    const Rect& window = wanted.view.window;
    frame::FilmTile block(intersection({window.x, window.y, Edge, Edge}, {window.x, window.y, 200, 200}),
                          {0, static_cast<std::uint32_t>(random_.below(5))}, wanted.view.channels);
    std::fill(block.counts.begin(), block.counts.end(), static_cast<std::uint32_t>(block.block.count()));
    std::vector<std::byte> bytes =
        wire::encode(frame::FilmState{.blocks = {std::move(block)},
                                      .steps = static_cast<std::uint32_t>(random_.below(3) / 2),
                                      .wanted = {}});
    if (random_.chance(20)) bytes[random_.below(bytes.size())] ^= std::byte{0x10};
    wire::EarlierFilm film{.film = {.hash = blake2b(bytes), .byte_size = bytes.size()},
                           .scene_hash = edits_.state_hash(),
                           .render_revision = frame::RenderRevision};
    offered_.push_back({film.film.hash, std::move(bytes)});
    if (offered_.size() > 1) offered_.pop_front();
    return film;
}

template <class Message>
void RandomPeer::adjust(Message& message) {
    wire::test::fill(message, random_.stream());
    if constexpr (requires { message.number; })
        message.number = random_.chance(90) ? random_.below(6) : random_.extreme();
    if constexpr (requires { message.version; }) message.version = edits_.some_version();
    if constexpr (requires { message.known; }) message.known = edits_.some_version();
    if constexpr (requires { message.object; }) message.object = edits_.some_object();
    if constexpr (requires { message.objects; }) {
        for (ObjectId& object : message.objects) object = edits_.some_object();
    }
    if constexpr (requires { message.selection; }) {
        for (ObjectId& object : message.selection) object = edits_.some_object();
    }
    if constexpr (requires { message.text; }) message.text = random_.name("text");
    if constexpr (requires { message.reason.size(); }) message.reason = random_.name("reason");
    if constexpr (std::is_same_v<Message, wire::UnitReleased>) message = film_.release(settings_.may_forge);
    if constexpr (std::is_same_v<Message, wire::RequestView>) {
        adjust_view(message.wanted);
        if (random_.chance(80)) message.earlier.reset();
        if (random_.chance(15)) message.earlier = earlier_film(message.wanted);
    }
    if constexpr (std::is_same_v<Message, wire::JoinScene>) {
        // No exclusive scene that others would wait for.
        message.no_wait = message.no_wait || message.exclusive;
        message.key = random_.below(3);
    }
    if constexpr (std::is_same_v<Message, wire::VersionReport>) {
        if (random_.chance(90)) message.state_hash = edits_.state_hash();
    }
    if constexpr (std::is_same_v<Message, wire::Heartbeat>) {
        if (random_.chance(80)) message.phase = session::NodePhase::Idle;
        message.in_flight = film_.units();
        message.free_slots =
            static_cast<std::uint32_t>(random_.chance(80) ? random_.below(8) : random_.extreme());
        message.last_work_sequence = random_.extreme();
    }
    if constexpr (std::is_same_v<Message, wire::Hello>) {
        message.protocol = random_.chance(90) ? wire::ProtocolVersion : message.protocol;
        message.kind = random_.chance(80) ? frame::with_render_revision("null-1") : message.kind;
        message.name = random_.name(settings_.name);
        if (settings_.role == net::Role::Node) message.peer = wire::PeerKind::Node;
        message.resume_token = random_.chance(50) ? token_ : random_.extreme();
    }
    if constexpr (std::is_same_v<Message, wire::ManageNode>) {
        message.name =
            "node " + std::to_string(random_.below(8));  // not an honest one: they end when drained
    }
    if constexpr (requires { message.view.size(); }) message.view = view_name();
    if constexpr (requires { message.job.name; }) message.job.name = view_name();
}

wire::BulkMessage RandomPeer::filled(wire::BulkMessage message) {
    const auto some_blob = [&](Hash256& hash) {
        wire::test::fill(hash, random_.stream());
        if (!blobs_.empty() && random_.chance(80)) hash = blobs_[random_.below(blobs_.size())];
    };
    if (std::holds_alternative<wire::FilmPart>(message))
        return film_.film(edits_.version(), settings_.may_forge);
    if (auto* hello = std::get_if<wire::BulkHello>(&message)) {
        hello->token = random_.chance(80) ? token_ : random_.extreme();
    } else if (auto* request = std::get_if<wire::BlobRequest>(&message)) {
        some_blob(request->hash);
        request->offset = random_.extreme();
    } else if (auto* absent = std::get_if<wire::BlobAbsent>(&message)) {
        some_blob(absent->hash);
    } else if (auto* chunk = std::get_if<wire::BlobChunk>(&message)) {
        chunk->total = 1 + random_.below(1 << 20);
        some_blob(chunk->hash);
        chunk->data.resize(random_.below(chunk->total), std::byte{1});
    }
    return message;
}

}  // namespace tessera::test
