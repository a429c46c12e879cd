#pragma once

#include <deque>
#include <map>
#include <optional>
#include <string>

#include "mediator/net/channel.h"
#include "mediator/net/clock_offset.h"
#include "mediator/net/liveness.h"
#include "mediator/wire/blob_transfer.h"
#include "mediator/wire/messages.h"

namespace tessera::master {

// What the master knows of one client.
struct SessionRecord {
    SessionId id;
    std::uint64_t token = 0;
    net::PeerId control = 0;
    std::optional<net::PeerId> bulk;
    std::string user;
    net::Role role = net::Role::Viewer;
    wire::Hello hello;
    net::Liveness liveness;
    wire::BlobFetcher fetcher;
    // Edits in the order of arrival; the first waits until its blobs have arrived.
    struct PendingEdit {
        std::optional<scene::BlobRef> encoded = {};  // the edit itself is a blob that has not arrived
        scene::Edit edit;
        std::uint64_t bytes = 0;   // that it took on the wire
        std::string refusal = {};  // its answer, when its turn comes; "" = it is applied
    };
    std::deque<PendingEdit> edits;
    bool edits_wait = false;  // for the scene authority: their blobs are here, or the first is being applied
    bool edit_runs = false;   // the first is being applied
    // Control messages that wait until an edit has been applied, in the order of arrival.
    struct HeldMessage {
        wire::ControlMessage message;
        std::size_t byte_size = 0;
    };
    std::deque<HeldMessage> held;
    std::size_t held_bytes = 0;
    std::optional<wire::OpenDisplay> opening;     // waits until its blobs have arrived
    std::optional<wire::RequestView> continuing;  // likewise: a view with earlier film
    bool film_is_being_decoded = false;           // of that view
    std::int64_t heartbeat_sent_at = 0;  // its latest, and when it came: what our next heartbeat echoes
    TimePoint heartbeat_at{};
    net::PeerClock clock;
    std::uint32_t reported_position = 0;     // in the queue, as last sent to the client
    std::optional<wire::JoinScene> joining;  // waits in the queue
};

// All clients, and the queue of those that wait for the scene, in order of arrival.
class SessionTable {
  public:
    SessionRecord& add(SessionRecord record) {
        const SessionId id = record.id;
        return sessions_.insert_or_assign(id, std::move(record)).first->second;
    }
    void remove(SessionId id);
    SessionRecord* find(SessionId id);
    SessionRecord* by_control(net::PeerId peer);
    SessionRecord* by_bulk(net::PeerId peer);
    SessionRecord* by_token(std::uint64_t token);
    std::map<SessionId, SessionRecord>& all() { return sessions_; }
    const std::map<SessionId, SessionRecord>& all() const { return sessions_; }

    void enqueue(SessionId id);  // harmless when already queued
    void leave_queue(SessionId id) { std::erase(queue_, id); }
    std::uint32_t queue_position(SessionId id) const;  // 1 = next; 0 = not waiting
    const std::deque<SessionId>& queue() const { return queue_; }

  private:
    std::map<SessionId, SessionRecord> sessions_;
    std::deque<SessionId> queue_;
};

}  // namespace tessera::master
