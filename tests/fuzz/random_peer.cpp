#include "tests/fuzz/random_peer.h"

#include <algorithm>
#include <limits>
#include <map>
#include <ranges>

#include "mediator/view/view.h"
#include "mediator/wire/envelope.h"
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

// What an honest client could not go on after: the orders of an operator to nodes, and the end of the scene.
bool ends_the_test(const wire::ControlMessage& message) {
    return std::holds_alternative<wire::CloseScene>(message) ||
           std::holds_alternative<wire::ManageNode>(message);
}

template <class Table, class Message>
std::vector<Message> kinds_of(net::Role role) {
    std::vector<Message> kinds;
    Table::for_each([&](const Message& message, std::string_view) {
        if (may_send(role, Table::senders(message))) kinds.push_back(message);
    });
    return kinds;
}

}  // namespace

Reached& Reached::operator+=(const Reached& other) {
    edits += other.edits;
    requests += other.requests;
    frames += other.frames;
    units += other.units;
    return *this;
}

RandomPeer::RandomPeer(std::unique_ptr<net::Channel> channel, const Settings& settings, std::uint64_t seed)
    : channel_(std::move(channel)), settings_(settings), random_(seed, 0) {
    greet();
}

bool RandomPeer::send(const wire::ControlMessage& message) {
    const bool sent =
        channel_->send(net::Link::Control, net::ServerPeer, wire::encode(message)) == net::SendResult::Sent;
    sent_ += sent ? 1 : 0;
    return sent;
}

bool RandomPeer::send(const wire::BulkMessage& message) {
    const bool sent =
        channel_->send(net::Link::Bulk, net::ServerPeer, wire::encode(message)) == net::SendResult::Sent;
    sent_ += sent ? 1 : 0;
    return sent;
}

void RandomPeer::greet() {
    wire::Hello hello{
        .peer = settings_.role == net::Role::Node ? wire::PeerKind::Node : wire::PeerKind::Client,
        .name = settings_.name};
    hello.backend = "null";
    hello.kind = "null-1/r1";
    hello.channels = frame::ChannelSet::all();
    hello.concurrent_units = 1 + static_cast<std::uint32_t>(random_.below(wire::MaxConcurrentUnits));
    hello.resume_token = chance(50) ? token_ : 0;
    greeted_ = send(hello);
}

void RandomPeer::say_goodbye() {
    (void)send(wire::Goodbye{.reason = "done", .units_sent = {}});
    channel_->close();
}

void RandomPeer::take(const wire::ControlMessage& message) {
    if (const auto* welcome = std::get_if<wire::Welcome>(&message)) {
        token_ = welcome->token;
        version_.epoch = welcome->epoch;
        welcome_ = true;
        (void)send(wire::BulkHello{token_});
    } else if (std::holds_alternative<wire::Unknown>(message)) {
        welcome_ = joined_ = false;
        greet();
    } else if (const auto* joined = std::get_if<wire::SceneJoined>(&message)) {
        if (joined->queue_position != 0) return;
        joined_ = true;
        version_ = joined->version;
        first_id_ = joined->first_id;
        id_count_ = joined->id_count;
        sequence_ = joined->last_sequence;
        created_.clear();  // known again as they are created
        waiting_.clear();
    } else if (const auto* reply = std::get_if<wire::EditReply>(&message)) {
        answered(*reply);
    } else if (const auto* done = std::get_if<wire::RequestDone>(&message)) {
        reached_.requests += done->accepted ? 1 : 0;
    } else if (const auto* content = std::get_if<wire::SceneContent>(&message)) {
        if (!content->blob.empty()) blobs_.push_back(content->blob.hash);
    } else if (const auto* changes = std::get_if<wire::ChangesByBlob>(&message)) {
        blobs_.push_back(changes->blob.hash);
        version_ = changes->to;
    } else if (const auto* list = std::get_if<wire::Changes>(&message)) {
        version_ = list->list.to;
        state_hash_ = list->list.state_hash;
    } else if (const auto* work = std::get_if<wire::Work>(&message)) {
        units_.push_back(work->unit);
        ++reached_.units;
    } else if (const auto* view = std::get_if<wire::OpenView>(&message)) {
        views_.push_back(*view);
    }
    if (units_.size() > 256) units_.pop_front();
    if (views_.size() > 16) views_.pop_front();
    if (blobs_.size() > 16) blobs_.erase(blobs_.begin());
}

void RandomPeer::read() {
    while (true) {
        net::Received received = channel_->receive(TimePoint{});
        const auto* message = std::get_if<net::Message>(&received);
        if (message == nullptr) return;
        if (message->link == net::Link::Bulk) {
            const auto bulk = wire::decode_bulk(message->bytes);
            reached_.frames += bulk && std::holds_alternative<wire::FrameHeader>(*bulk) ? 1 : 0;
            continue;
        }
        if (const auto decoded = wire::decode_control(message->bytes)) take(*decoded);
    }
}

bool RandomPeer::act() {
    read();
    if (!greeted_) greet();
    if (settings_.joins && welcome_ && !joined_ && settings_.role != net::Role::Node && chance(30)) {
        return send(wire::JoinScene{.title = "of " + settings_.name,
                                    .name = settings_.name,
                                    .key = settings_.role == net::Role::Viewer ? 0 : 1 + random_.below(3)});
    }
    return chance(20) ? send_bulk() : send_control();
}

std::uint64_t RandomPeer::extreme() {
    constexpr std::uint64_t Edges[] = {0, 1, 2, 255, 65535, 65536, 0x7fffffff, 0xffffffff, ~0ull >> 1, ~0ull};
    return chance(50) ? random_.below(64) : Edges[random_.below(std::size(Edges))];
}

ObjectId RandomPeer::some_object() {
    if (chance(60) && id_count_ > 0)
        return ObjectId{first_id_ + random_.below(std::min<std::uint64_t>(id_count_, 64))};
    if (chance(50)) return ObjectId{settings_.spared.value + random_.below(64)};
    return chance(30) ? scene::RootId : ObjectId{extreme()};
}

Version RandomPeer::some_version() {
    Version version = version_;
    if (chance(30)) version.number += random_.below(5);
    if (chance(10)) version = {extreme(), extreme()};
    return version;
}

void RandomPeer::adjust_view(session::ViewRequest& wanted) {
    session::ViewRequest request{.stop = {.spp = chance(80) ? 1 + random_.below(64) : extreme()}};
    request.view.width = static_cast<std::uint32_t>(chance(95) ? 1 + random_.below(200) : extreme());
    request.view.height = static_cast<std::uint32_t>(chance(95) ? 1 + random_.below(200) : extreme());
    request.view.window = {0, 0, static_cast<std::int32_t>(request.view.width),
                           static_cast<std::int32_t>(request.view.height)};
    if (chance(10)) request.view.window = wanted.view.window;
    request.view.camera = chance(70) ? view::perspective(glm::dmat4(1.0), 0.8, 1.0) : wanted.view.camera;
    request.view.channels = chance(70) ? frame::ChannelSet{frame::Channel::Radiance} : wanted.view.channels;
    request.view.filter = chance(50) ? "" : chance(50) ? "gauss" : wanted.view.filter;
    request.picture = wanted.picture;
    request.frames = wanted.frames;
    request.film = wanted.film;
    request.min_nodes = chance(90) ? 0 : wanted.min_nodes;
    request.wait_limit = wanted.wait_limit;
    if (chance(20)) request.stop = wanted.stop;
    request.name = chance(70) ? "" : "view " + std::to_string(random_.below(8));
    request.detached = chance(20) && !request.name.empty();
    wanted = std::move(request);
}

// Of its own objects; most of them are accepted.
std::vector<scene::Entry> RandomPeer::plain_entries(std::uint64_t sequence) {
    std::vector<scene::Entry> entries;
    std::set<ObjectId> touched;
    for (std::uint64_t i = 1 + random_.below(5); i > 0; --i) {
        const auto name = "object " + std::to_string(random_.below(1000));
        const bool creates = created_.empty() || chance(30);
        const ObjectId id =
            creates
                ? ObjectId{first_id_ + next_object_++ % std::max<std::uint64_t>(1, id_count_)}
                : *std::next(created_.begin(), static_cast<std::ptrdiff_t>(random_.below(created_.size())));
        if (!touched.insert(id).second) continue;
        if (creates) {
            entries.emplace_back(scene::Create{id, scene::Transform{.name = name}});
            waiting_[sequence].created.push_back(id);
        } else if (chance(80)) {
            scene::Transform moved{.name = name};
            moved.matrix[3] = {double(random_.below(1000)), 0, 0, 1};
            entries.emplace_back(scene::Update{
                id,
                scene::Fields<scene::Transform>(&scene::Transform::name, &scene::Transform::matrix).bits(),
                moved});
        } else {
            entries.emplace_back(scene::Remove{id});
            waiting_[sequence].removed.push_back(id);
        }
    }
    return entries;
}

void RandomPeer::answered(const wire::EditReply& reply) {
    const auto edit = waiting_.extract(reply.sequence);
    if (reply.result.accepted) {
        ++reached_.edits;
        if (edit.empty()) return;
        for (const ObjectId id : edit.mapped().removed) created_.erase(id);
        created_.insert(edit.mapped().created.begin(), edit.mapped().created.end());
        return;
    }
    // An edit that did not arrive leaves a gap.
    constexpr std::string_view Expected = "expected ";
    for (const std::string& problem : reply.result.problems) {
        const std::size_t at = problem.find(Expected);
        if (at != std::string::npos) sequence_ = std::stoull(problem.substr(at + Expected.size())) - 1;
    }
}

void RandomPeer::adjust_edit(scene::Edit& edit) {
    edit.sequence = chance(90) ? ++sequence_ : extreme();
    edit.undo = chance(80) ? 0 : chance(50) ? scene::UndoLatest : extreme();
    edit.edit_group = random_.below(3);
    if (edit.undo != 0 && chance(80)) edit.entries.clear();
    if (edit.undo == 0 && chance(70)) {
        edit.entries = plain_entries(edit.sequence);
        return;
    }
    for (scene::Entry& entry : edit.entries) {
        std::visit([&](auto& each) { each.id = some_object(); }, entry);
        // Transforms and roots make graphs of any shape.
        if (auto* create = std::get_if<scene::Create>(&entry); create && chance(50)) {
            scene::Transform transform{.name = "t"};
            for (std::uint64_t i = random_.below(4); i > 0; --i) transform.children.push_back(some_object());
            create->object = transform;
        }
    }
}

template <class Message>
void RandomPeer::adjust(Message& message) {
    wire::test::fill(message, random_);
    if constexpr (requires { message.number; }) message.number = chance(90) ? random_.below(6) : extreme();
    if constexpr (requires { message.version; }) message.version = some_version();
    if constexpr (requires { message.known; }) message.known = some_version();
    if constexpr (requires { message.object; }) message.object = some_object();
    if constexpr (requires { message.objects; }) {
        for (ObjectId& object : message.objects) object = some_object();
    }
    if constexpr (std::is_same_v<Message, wire::UnitReleased>) {
        if (!units_.empty() && chance(80)) {
            message.unit = units_.front().id;
            if (chance(70)) units_.pop_front();
        }
    }
    if constexpr (std::is_same_v<Message, wire::RequestView>) adjust_view(message.wanted);
    if constexpr (std::is_same_v<Message, wire::SubmitEdit>) adjust_edit(message.edit);
    if constexpr (std::is_same_v<Message, wire::JoinScene>) {
        message.no_wait =
            message.no_wait || message.exclusive;  // no exclusive scene that others would wait for
        message.key = random_.below(3);
    }
    if constexpr (std::is_same_v<Message, wire::VersionReport>) {
        if (chance(90)) message.state_hash = state_hash_;
    }
    if constexpr (std::is_same_v<Message, wire::Heartbeat>) {
        if (chance(80)) message.phase = session::NodePhase::Idle;
        message.in_flight.clear();
        for (const view::WorkUnit& unit : units_) message.in_flight.push_back(unit.id);
        message.free_slots = static_cast<std::uint32_t>(chance(50) ? random_.below(8) : extreme());
        message.last_work_sequence = extreme();
    }
    if constexpr (std::is_same_v<Message, wire::Hello>) {
        message.protocol = chance(90) ? wire::ProtocolVersion : message.protocol;
        message.kind = chance(80) ? "null-1/r1" : message.kind;
        message.name = settings_.name;
        if (settings_.role == net::Role::Node) message.peer = wire::PeerKind::Node;
        message.resume_token = chance(50) ? token_ : extreme();
        joined_ = welcome_ = false;
    }
    if constexpr (std::is_same_v<Message, wire::SetViewFilter> || std::is_same_v<Message, wire::FetchJob> ||
                  std::is_same_v<Message, wire::CancelJob>) {
        const std::string name = "view " + std::to_string(random_.below(8));
        if constexpr (requires { message.view; }) message.view = name;
        if constexpr (requires { message.job.name; }) message.job.name = name;
    }
}

bool RandomPeer::send_control() {
    static const auto Kinds = [] {
        std::map<net::Role, std::vector<wire::ControlMessage>> kinds;
        for (const net::Role role :
             {net::Role::Viewer, net::Role::Editor, net::Role::Node, net::Role::Operator})
            kinds[role] = kinds_of<wire::table::Control, wire::ControlMessage>(role);
        return kinds;
    }();
    const auto& kinds = Kinds.at(settings_.role);
    wire::ControlMessage message = kinds[random_.below(kinds.size())];
    // Edits and views lead to the most, so that every fourth message is one.
    if (joined_ && chance(25)) {
        if (chance(50)) {
            message = wire::RequestView{};
        } else if (may_send(settings_.role, wire::Senders::Editors)) {
            message = wire::SubmitEdit{};
        }
    }
    const bool ends = std::holds_alternative<wire::Goodbye>(message);
    if (ends && !chance(10)) message = wire::Heartbeat{};
    // A greeting ends the session; what comes after is for a new one.
    const bool greets = std::holds_alternative<wire::Hello>(message);
    if (ends_the_test(message) || (greets && !chance(5))) message = wire::Heartbeat{};
    std::visit([&](auto& each) { adjust(each); }, message);
    if (std::holds_alternative<wire::Goodbye>(message)) joined_ = welcome_ = greeted_ = false;
    if (!wire::fits_control(wire::encode(message))) return true;  // would not be sent by anyone
    return send(message);
}

wire::FilmPart RandomPeer::film() {
    wire::FilmPart part;
    if (units_.empty() || chance(20)) {
        part.unit = UnitId{extreme()};
        part.view = ViewId{extreme()};
        part.film = frame::FilmTile({0, 0, 8, 8}, {0, 1}, {frame::Channel::Radiance});
        return part;
    }
    const view::WorkUnit unit = units_.front();
    if (chance(70)) units_.pop_front();
    part.unit = unit.id;
    part.view = unit.view;
    part.revision = unit.revision;
    part.version = version_;
    part.units = static_cast<std::uint32_t>(chance(90) ? 1 : extreme());
    part.rays = extreme();
    part.busy_ns = extreme();
    frame::ChannelSet channels{frame::Channel::Radiance};
    for (const wire::OpenView& view : views_) {
        if (view.view.id == unit.view) channels = view.view.channels;
    }
    part.film = frame::FilmTile(unit.tile, unit.block, channels);
    const bool forges = settings_.may_forge && chance(50);
    if (!forges) std::ranges::fill(part.film.planes, std::numeric_limits<float>::quiet_NaN());
    return part;
}

bool RandomPeer::send_bulk() {
    wire::BulkMessage message = wire::BlobAbsent{};
    switch (random_.below(settings_.role == net::Role::Node ? 4 : 3)) {
        case 0: {
            wire::BlobRequest request;
            wire::test::fill(request, random_);
            if (!blobs_.empty() && chance(90)) request.hash = blobs_[random_.below(blobs_.size())];
            request.offset = extreme();
            message = request;
            break;
        }
        case 1: {
            wire::BlobChunk chunk{.total = 1 + random_.below(1 << 20), .offset = 0, .data = {}};
            wire::test::fill(chunk.hash, random_);
            if (!blobs_.empty() && chance(50)) chunk.hash = blobs_[random_.below(blobs_.size())];
            chunk.data.resize(random_.below(chunk.total), std::byte{1});
            message = chunk;
            break;
        }
        case 2:
            message = wire::BulkHello{chance(80) ? token_ : extreme()};
            break;
        default:
            message = film();
    }
    return send(message);
}

}  // namespace tessera::test
