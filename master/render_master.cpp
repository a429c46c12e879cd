#include "master/render_master.h"

#include <algorithm>
#include <functional>
#include <random>
#include <thread>

#include "master/peers/roles.h"
#include "mediator/wire/envelope.h"

namespace tessera::master {

namespace {

std::uint64_t random_nonzero() {
    std::random_device device;
    std::uint64_t value = 0;
    while (value == 0) value = (std::uint64_t{device()} << 32) | device();
    return value;
}

wire::Heartbeat heartbeat(TimePoint now, std::int64_t echo_sent_at, TimePoint echo_received,
                          Version version) {
    wire::Heartbeat beat{.sent_at = now.time_since_epoch().count(), .version = version};
    if (echo_sent_at != 0) {
        beat.echo_sent_at = echo_sent_at;
        beat.echo_delay = (now - echo_received).count();
    }
    return beat;
}

}  // namespace

RenderMaster::RenderMaster(std::unique_ptr<net::Channel> channel, std::shared_ptr<scene::BlobStore> blobs,
                           const Clock& clock, const MasterSettings& settings, EventSink events)
    : channel_(std::move(channel)),
      blobs_(std::move(blobs)),
      clock_(clock),
      settings_(settings),
      limiter_(clock, std::move(events)),
      events_([this](const Event& event) { limiter_(event); }),
      started_(clock.now()),
      guard_(clock, events_, monitor_),
      outbox_(*channel_),
      nodes_(settings.liveness, settings.stuck),
      outputs_(*channel_),
      film_(outputs_),
      jobs_(events_),
      dispatcher_(settings.views.overdue_patience, clock, nodes_, outbox_, events_,
                  {.share = settings.verified_share, .seed = random_nonzero()}),
      scene_(settings.epoch != 0 ? settings.epoch : random_nonzero(), settings.views,
             {.blobs = blobs_,
              .nodes = nodes_,
              .sessions = sessions_,
              .outbox = outbox_,
              .render = {outputs_, film_, dispatcher_, view_ids_},
              .jobs = jobs_,
              .events = events_,
              .collect_interval = settings.collect_interval,
              .memory_limit = settings.memory_limit}),
      service_(blobs_, settings.blob_limits.bytes_total, sessions_, scene_, outbox_) {
    if (settings.session_folder.empty()) return;
    scene_.record_to(settings.session_folder, settings.checkpoint_interval, started_);
}

void RenderMaster::post(std::function<void(net::Channel&)> task) {
    {
        const std::scoped_lock lock(mutex_);
        posted_.push_back(std::move(task));
    }
    channel_->wake();
}

void RenderMaster::run(std::stop_token stop) {
    const std::stop_callback wake_on_stop(stop, [this] { channel_->wake(); });
    while (!stop.stop_requested()) {
        // Receiving can fail as well: the link, not a message.
        if (!guard_.attempt("the event loop", [&] { step(clock_.now(), stop); }))
            std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    guard_.run("writing the last checkpoint", [&] { save_at_the_end(); });
    guard_.run("saying goodbye", [&] { send_goodbye(); });
}

// Film is copied and written by other threads.
void RenderMaster::save_at_the_end() {
    constexpr Duration Limit = std::chrono::seconds(20);
    const TimePoint end = clock_.now() + Limit;
    while (!scene_.save_at_the_end(clock_.now()) && clock_.now() < end) {
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
        for (RenderOutput& output : outputs_.take()) scene_.take(output, clock_.now());
    }
}

void RenderMaster::step(TimePoint now, std::stop_token stop) {
    const TimePoint deadline = intake_.empty() ? next_wake(now) : now;
    net::Received received = channel_->receive(deadline);
    const TimePoint begun = clock_.now();
    const Duration cpu_before = LoopMonitor::thread_cpu_time();
    // The whole process stood still, and woke later than it wanted to.
    forgive_silence(begun - std::max(deadline, now_before_), begun);
    const bool heard_all = take_in(std::move(received));
    monitor_.ran("receiving", LoopMonitor::thread_cpu_time() - cpu_before);
    serve_messages(begun, stop);
    if (stop.stop_requested()) return;
    now = clock_.now();
    run_posted();
    for (RenderOutput& output : outputs_.take())
        guard_.run("taking the result of a thread", [&] { scene_.take(output, now); });
    serve_held_messages(now);
    guard_.run("collecting overdue units", [&] { dispatcher_.collect_overdue(now); });
    guard_.run("serving clients", [&] { service_.tick(now); });
    guard_.run("the scene's tick", [&] { scene_.tick(now); });
    guard_.run("repairing nodes' scenes",
               [&] { scene_.distributor().repair(nodes_, now, 3 * settings_.liveness.interval); });
    guard_.run("acknowledging film", [&] { dispatcher_.send_film_taken(); });
    guard_.run("sending heartbeats", [&] { heartbeats(now); });
    guard_.run("sending", [&] { outbox_.flush(); });
    const TimePoint end = clock_.now();
    monitor_.stepped(end - begun, LoopMonitor::thread_cpu_time() - cpu_before);
    now_before_ = end;
    forgive_silence(end - begun, end);
    if (heard_all && intake_.empty()) guard_.run("dropping lost peers", [&] { drop_lost_peers(end); });
    limiter_.tick();
    if (heard_all) guard_.run("removing silent peers", [&] { remove_timed_out_peers(end); });
}

// Film goes to its thread at once; other messages wait for their turn.
bool RenderMaster::take_in(net::Received received) {
    constexpr int BurstLimit = 256;  // both limits: so that nothing else is delayed
    constexpr Duration BurstTime = std::chrono::milliseconds(2);
    const TimePoint begun = clock_.now();
    for (int taken = 1;; ++taken) {
        auto* message = std::get_if<net::Message>(&received);
        if (message == nullptr) return true;
        const TimePoint now = clock_.now();
        if (message->link == net::Link::Bulk && wire::is_film(message->bytes)) {
            receive(std::move(*message), now);
        } else {
            // It is a sign of life, even if it has to wait.
            const bool is_control = message->link == net::Link::Control;
            if (!intake_.empty()) {
                if (NodeRecord* node =
                        is_control ? nodes_.by_control(message->peer) : nodes_.by_bulk(message->peer))
                    node->liveness.on_message(now);
                if (SessionRecord* session =
                        is_control ? sessions_.by_control(message->peer) : sessions_.by_bulk(message->peer))
                    session->liveness.on_message(now);
            }
            if (!intake_.put(*message)) drop(*message, "too many messages of this key wait");
        }
        if (taken == BurstLimit || now - begun >= BurstTime) return false;
        received = channel_->receive(TimePoint{});  // only what has already arrived
    }
}

void RenderMaster::serve_messages(TimePoint begun, const std::stop_token& stop) {
    constexpr Duration Budget = std::chrono::milliseconds(5);
    TimePoint now = clock_.now();
    while (!intake_.empty() && !stop.stop_requested()) {
        net::Message message = intake_.take();
        const std::string user = message.user;
        const Duration before = LoopMonitor::thread_cpu_time();
        message_kind_ = "a malformed message";
        receive(std::move(message), now);
        monitor_.ran(message_kind_, LoopMonitor::thread_cpu_time() - before);
        const TimePoint after = clock_.now();
        intake_.used(user, after - now);
        now = after;
        if (now - begun > Budget) return;
    }
}

// What peers sent meanwhile has not been read yet: they do not count as silent.
void RenderMaster::forgive_silence(Duration time, TimePoint now) {
    if (time < settings_.liveness.interval / 4) return;
    if (time >= settings_.liveness.interval * settings_.liveness.missed)
        broken_until_ = now + settings_.liveness.max_backoff;
    for (auto& [id, node] : nodes_.all()) node.liveness.was_deaf(time, now);
    for (auto& [id, session] : sessions_.all()) session.liveness.was_deaf(time, now);
}

void RenderMaster::run_posted() {
    std::vector<std::function<void(net::Channel&)>> posted;
    {
        const std::scoped_lock lock(mutex_);
        posted.swap(posted_);
    }
    for (const auto& task : posted) guard_.run("a task of the operator", [&] { task(*channel_); });
}

TimePoint RenderMaster::next_wake(TimePoint now) const {
    TimePoint next = now + settings_.liveness.interval / 4;
    next = std::min(next, scene_.next_event(now));
    if (outbox_.waiting()) next = std::min(next, now + std::chrono::milliseconds(1));
    if (!lost_.empty()) next = std::min(next, now + std::chrono::milliseconds(10));
    return next;
}

void RenderMaster::drop(const net::Message& message, const std::string& why) {
    ++dropped_messages_;
    events_({wire::Severity::Warning,
             "message of " + (message.user.empty() ? "a peer" : message.user) + " was dropped: " + why});
}

void RenderMaster::receive(net::Message&& message, TimePoint now) {
    // The policy for exceptions of message handlers: the master always continues.
    try {
        if (message.link == net::Link::Control) {
            control(message, now);
        } else {
            bulk(message, now);
        }
    } catch (const std::exception& error) {
        drop(message, error.what());
    }
}

void RenderMaster::control(net::Message& message, TimePoint now) {
    outbox_.bytes.control += message.bytes.size();
    auto decoded = wire::decode_control(message.bytes);
    if (!decoded) return drop(message, decoded.error().what());
    message_kind_ = wire::table::Control::name(*decoded);
    if (!allowed(message.role, *decoded)) {
        outbox_.control(message.peer, wire::Refusal{std::string("the role ") + net::name(message.role) +
                                                    " may not do this: use a key with another role"});
        return drop(message, "not allowed for its role");
    }
    if (auto* greeting = std::get_if<wire::Hello>(&*decoded))
        return hello(message, std::move(*greeting), now);
    if (NodeRecord* node = nodes_.by_control(message.peer); node && node->user == message.user) {
        node->liveness.on_message(now);
        return from_node(*node, *decoded, now);
    }
    if (SessionRecord* session = sessions_.by_control(message.peer);
        session && session->user == message.user) {
        session->liveness.on_message(now);
        if (must_wait(*session, *decoded)) return hold(*session, message, std::move(*decoded));
        return from_client(*session, *decoded, message.bytes.size(), now);
    }
    if (!std::holds_alternative<wire::Goodbye>(*decoded)) outbox_.control(message.peer, wire::Unknown{});
}

void RenderMaster::bulk(net::Message& message, TimePoint now) {
    if (!wire::is_bulk(message.bytes)) return drop(message, "not a bulk message");
    if (wire::is_film(message.bytes)) {
        NodeRecord* node = nodes_.by_bulk(message.peer);
        if (!allowed(message.role, wire::BulkMessage(wire::FilmPart{})) || !node ||
            node->user != message.user) {
            return drop(message, "film from a peer that is not a registered node");
        }
        const std::size_t size = message.bytes.size();
        outbox_.bytes.film += size;
        node->liveness.on_message(now);
        const auto head = wire::film_head(message.bytes);
        if (!head) return dispatcher_.malformed_film(*node, "film with a damaged header", size, now);
        if (auto admission = dispatcher_.admit(*node, *head, size, now))
            film_.push(node->id, *head, *std::move(admission), std::move(message.bytes));
        return;
    }
    auto decoded = wire::decode_bulk(message.bytes);
    if (!decoded) return drop(message, decoded.error().what());
    message_kind_ = wire::table::Bulk::name(*decoded);
    if (!allowed(message.role, *decoded)) return drop(message, "not allowed for its role");
    if (const auto* greeting = std::get_if<wire::BulkHello>(&*decoded)) return bulk_hello(message, *greeting);
    if (NodeRecord* node = nodes_.by_bulk(message.peer); node && node->user == message.user) {
        node->liveness.on_message(now);
        const auto* request = std::get_if<wire::BlobRequest>(&*decoded);
        if (request == nullptr) return drop(message, "nodes may not send this kind of message");
        return outbox_.bulk(message.peer, wire::answer(*request, *blobs_));
    }
    if (SessionRecord* session = sessions_.by_bulk(message.peer); session && session->user == message.user) {
        session->liveness.on_message(now);
        if (auto* chunk = std::get_if<wire::BlobChunk>(&*decoded)) {
            return service_.chunk(*session, std::move(*chunk), now);
        }
        if (const auto* absent = std::get_if<wire::BlobAbsent>(&*decoded)) {
            return service_.absent(*session, *absent, now);
        }
        if (const auto* request = std::get_if<wire::BlobRequest>(&*decoded)) {
            // Clients have 32 requests under way, and repeat those that are not answered.
            constexpr std::size_t MaxWaiting = std::size_t{64} << 20;
            if (outbox_.waiting_bytes(net::Link::Bulk, message.peer) > MaxWaiting)
                return drop(message, "it asks for blobs faster than it receives them");
            if (scene_.may_fetch(*session, request->hash))
                return outbox_.bulk(message.peer, wire::answer(*request, *blobs_));
            outbox_.bulk(message.peer, wire::BlobAbsent{request->hash});
            return drop(message, "viewers may not read the blobs of the scene");
        }
        return drop(message, "clients may not send this kind of message");
    }
    drop(message, "unauthenticated bulk connection: its first message must carry the session token");
}

void RenderMaster::bulk_hello(const net::Message& message, const wire::BulkHello& greeting) {
    if (NodeRecord* node = nodes_.by_token(greeting.token); node && node->user == message.user) {
        node->bulk = message.peer;
        return;
    }
    if (SessionRecord* session = sessions_.by_token(greeting.token);
        session && session->user == message.user) {
        session->bulk = message.peer;
        return;
    }
    drop(message, "unknown session token");
}

void RenderMaster::welcome(net::PeerId peer, std::uint64_t number, std::uint64_t token) {
    outbox_.control(
        peer, wire::Welcome{.peer_number = number,
                            .token = token,
                            .epoch = scene_.published().version().epoch,
                            .heartbeat_interval = settings_.liveness.interval,
                            .missed_heartbeats = static_cast<std::uint32_t>(settings_.liveness.missed)});
}

std::string RenderMaster::full_text(bool is_node, const net::Message& message) const {
    constexpr const char* Full = "the master is full: try again later";
    if (is_node) return nodes_.all().size() >= settings_.max_nodes ? Full : "";
    const bool is_operator = message.role == net::Role::Operator;
    const std::size_t reserved =
        is_operator ? 0 : std::min(settings_.sessions_for_operators, settings_.max_sessions);
    if (sessions_.all().size() >= settings_.max_sessions - reserved) return Full;
    const auto same_key = std::ranges::count_if(
        sessions_.all(), [&](const auto& entry) { return entry.second.user == message.user; });
    if (!is_operator && static_cast<std::size_t>(same_key) >= settings_.max_sessions_per_key)
        return "this key has " + std::to_string(same_key) + " sessions, as many as one may have: close some";
    return "";
}

void RenderMaster::hello(const net::Message& message, wire::Hello hello, TimePoint now) {
    const auto refuse = [&](const std::string& reason) {
        outbox_.control(message.peer, wire::Refusal{reason});
        events_({wire::Severity::Warning, "refused " + hello.name + ": " + reason});
    };
    if (hello.protocol != wire::ProtocolVersion) {
        return refuse("this master speaks protocol " + std::to_string(wire::ProtocolVersion) +
                      ", you speak " + std::to_string(hello.protocol) +
                      ": install the same version of Tessera on both");
    }
    const bool is_node = hello.peer == wire::PeerKind::Node;
    if (is_node && hello.render_revision != frame::RenderRevision) {
        return refuse("this master merges film of render revision " + std::to_string(frame::RenderRevision) +
                      ", yours is of revision " + std::to_string(hello.render_revision) +
                      ": install the same version of Tessera on both");
    }
    if (NodeRecord* node = is_node ? nodes_.by_token(hello.resume_token) : nullptr;
        node && node->user == message.user) {
        node->control = message.peer;
        node->bulk.reset();
        node->pending.clear();
        node->views.clear();
        node->sent = {};
        node->work_sequence = 0;
        node->film_taken = 0;
        node->liveness.restarted(now);
        welcome(message.peer, node->id.value, node->token);
        return scene_.distributor().joined(*node, now);
    }
    if (SessionRecord* session = is_node ? nullptr : sessions_.by_token(hello.resume_token);
        session && session->user == message.user) {
        session->control = message.peer;
        session->bulk.reset();
        session->liveness.restarted(now);
        scene_.views().session_resumed(session->id);
        return welcome(message.peer, session->id.value, session->token);
    }
    // A repeated Hello of a known peer (the reply to its first one was lost) starts a new session.
    if (NodeRecord* node = nodes_.by_control(message.peer))
        remove_node(node->id, "it reconnected", Dispatcher::Departure::Expected, now);
    if (SessionRecord* session = sessions_.by_control(message.peer))
        remove_session(session->id, Views::DisconnectReason::Timeout, now);
    if (const std::string full = full_text(is_node, message); !full.empty()) return refuse(full);
    const std::uint64_t number = next_number_++;
    const std::uint64_t token = random_nonzero();
    if (is_node) {
        if (const auto former = nodes_.removed(hello.resume_token)) dispatcher_.came_back(*former);
        events_({wire::Severity::Info,
                 "node " + hello.name + " joined (" + hello.backend + ", " + hello.kind + ")",
                 {.node = hello.name}});
        NodeRecord& node =
            nodes_.add(NodeId{number}, token, message.peer, message.user, std::move(hello), now);
        dispatcher_.joined(node, now);
        welcome(message.peer, number, token);
        return scene_.distributor().joined(node, now);
    }
    sessions_.add({.id = SessionId{number},
                   .token = token,
                   .control = message.peer,
                   .bulk = {},
                   .user = message.user,
                   .role = message.role,
                   .hello = std::move(hello),
                   .liveness = net::Liveness(settings_.liveness, now),
                   .fetcher = wire::BlobFetcher(blobs_, settings_.blob_limits),
                   .edits = {}});
    welcome(message.peer, number, token);
}

void RenderMaster::heartbeats(TimePoint now) {
    for (auto& [id, node] : nodes_.all()) {
        if (!node.liveness.heartbeat_due(now)) continue;
        node.liveness.sent_heartbeat(now);
        outbox_.control(node.control,
                        heartbeat(now, node.state.sent_at, node.heartbeat_at, scene_.published().version()));
    }
    for (auto& [id, session] : sessions_.all()) {
        if (!session.liveness.heartbeat_due(now)) continue;
        session.liveness.sent_heartbeat(now);
        outbox_.control(session.control, heartbeat(now, session.heartbeat_sent_at, session.heartbeat_at,
                                                   scene_.published().version()));
    }
}

void RenderMaster::send_goodbye() {
    for (auto& [id, node] : nodes_.all())
        outbox_.control(node.control, wire::Goodbye{"the master stops", {}});
    for (auto& [id, session] : sessions_.all()) {
        outbox_.control(session.control, wire::Goodbye{"the master stops", {}});
    }
    outbox_.flush();
}

}  // namespace tessera::master
