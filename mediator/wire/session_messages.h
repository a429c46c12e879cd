#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "mediator/base/clock.h"
#include "mediator/scene/change_list.h"
#include "mediator/session/edits.h"
#include "mediator/session/members.h"
#include "mediator/session/status.h"

// Messages between the members of a scene and the master. `request` is the client's request number and is repeated in
// the reply.
namespace tessera::wire {

// Joins the open scene, or opens one; an exclusive scene has one member. Answered by SceneJoined, with a position in
// the queue while the client has to wait, or by Refusal.
struct JoinScene {
    std::string title;  // of a newly opened scene; an open one keeps its title
    std::string name;   // display name of the member; made unique by the master
    std::uint64_t key =
        0;  // chosen by the client, secret: the same editor again after a restart of the master
    bool no_wait = false;
    bool exclusive = false;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "title", &JoinScene::title), row(2, "name", &JoinScene::name),
                          row(3, "key", &JoinScene::key, FullWidth{}), row(4, "no_wait", &JoinScene::no_wait),
                          row(5, "exclusive", &JoinScene::exclusive));
    }
};
struct SceneJoined {
    Version version;                           // published
    std::uint64_t first_id = 0, id_count = 0;  // allocated to this editor for new objects
    std::uint64_t last_sequence = 0;           // the last answered edit: later ones have to be sent again
    std::string title, name;
    std::uint32_t queue_position = 0;  // not 0: not joined yet; 1 = next
    static constexpr auto describe(auto row) {
        return std::tuple(
            row(1, "version", &SceneJoined::version), row(2, "first_id", &SceneJoined::first_id),
            row(3, "id_count", &SceneJoined::id_count), row(4, "last_sequence", &SceneJoined::last_sequence),
            row(5, "title", &SceneJoined::title), row(6, "name", &SceneJoined::name),
            row(7, "queue_position", &SceneJoined::queue_position));
    }
};
// The reply to requests without a specific reply.
struct RequestDone {
    std::uint64_t request = 0;
    bool accepted = false;
    std::string text;          // error, or additional information
    bool unavailable = false;  // not accepted, since the master's machine lacks what it needs
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "request", &RequestDone::request),
                          row(2, "accepted", &RequestDone::accepted), row(3, "text", &RequestDone::text),
                          row(4, "unavailable", &RequestDone::unavailable));
    }
};
// Closes the scene and its views; the next client in the queue is admitted.
struct CloseScene {
    std::uint64_t request = 0;
    static constexpr auto describe(auto row) { return std::tuple(row(1, "request", &CloseScene::request)); }
};

struct SubmitEdit {
    scene::Edit edit;
    static constexpr auto describe(auto row) { return std::tuple(row(1, "edit", &SubmitEdit::edit)); }
};
struct SubmitEditByBlob {
    SessionId session;
    std::uint64_t sequence = 0;
    Version base;
    scene::BlobRef blob;  // an encoded Edit
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "session", &SubmitEditByBlob::session),
                          row(2, "sequence", &SubmitEditByBlob::sequence),
                          row(3, "base", &SubmitEditByBlob::base), row(4, "blob", &SubmitEditByBlob::blob));
    }
};
struct EditReply {
    std::uint64_t sequence = 0;
    session::EditResult result;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "sequence", &EditReply::sequence), row(2, "result", &EditReply::result));
    }
};

// Requests the current scene: a change list from `known`, or a snapshot if that version is too old.
struct ReadScene {
    std::uint64_t request = 0;
    Version known;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "request", &ReadScene::request), row(2, "known", &ReadScene::known));
    }
};
struct SceneContent {
    std::uint64_t request = 0;
    scene::ChangeList list;
    scene::BlobRef blob;  // not empty: this blob contains the list
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "request", &SceneContent::request), row(2, "list", &SceneContent::list),
                          row(3, "blob", &SceneContent::blob));
    }
};

// While an object is locked, edits of others that touch it are refused. Locks go with their session.
struct LockObjects {
    std::uint64_t request = 0;
    std::vector<ObjectId> objects;
    bool release = false;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "request", &LockObjects::request), row(2, "objects", &LockObjects::objects),
                          row(3, "release", &LockObjects::release));
    }
};
// This member's current activity, shown to the others until `time_to_live` has passed. No answer.
struct SetPresence {
    std::string text;
    std::vector<ObjectId> selection;
    Duration time_to_live{};
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "text", &SetPresence::text), row(2, "selection", &SetPresence::selection),
                          row(3, "time_to_live", &SetPresence::time_to_live));
    }
};
struct ReadMembers {
    std::uint64_t request = 0;
    static constexpr auto describe(auto row) { return std::tuple(row(1, "request", &ReadMembers::request)); }
};
struct Members {
    std::uint64_t request = 0;
    session::Members content;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "request", &Members::request), row(2, "content", &Members::content));
    }
};

// Requests the latest transactions, newest first.
struct ReadHistory {
    std::uint64_t request = 0;
    std::uint32_t count = 0;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "request", &ReadHistory::request), row(2, "count", &ReadHistory::count));
    }
};
struct History {
    std::uint64_t request = 0;
    std::vector<session::TransactionSummary> transactions;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "request", &History::request),
                          row(2, "transactions", &History::transactions));
    }
};
// Requests the last writers of an object's fields; fields without one are as they were created.
struct ReadWriters {
    std::uint64_t request = 0;
    ObjectId object;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "request", &ReadWriters::request), row(2, "object", &ReadWriters::object));
    }
};
struct Writers {
    std::uint64_t request = 0;
    std::vector<session::FieldWriter> fields;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "request", &Writers::request), row(2, "fields", &Writers::fields));
    }
};

// Requests the latency traces of the latest edits.
struct ReadTrace {
    std::uint64_t request = 0;
    std::uint32_t count = 0;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "request", &ReadTrace::request), row(2, "count", &ReadTrace::count));
    }
};
struct Trace {
    std::uint64_t request = 0;
    std::vector<session::EditTrace> edits;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "request", &Trace::request), row(2, "edits", &Trace::edits));
    }
};

// An operator's order about all nodes of that name. Answered by RequestDone.
struct ManageNode {
    enum class Order : std::uint8_t {
        Release,  // from quarantine: it gets work again
        Drain     // it finishes what it renders, and leaves
    };
    std::uint64_t request = 0;
    std::string name;
    Order order = Order::Release;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "request", &ManageNode::request), row(2, "name", &ManageNode::name),
                          row(3, "order", &ManageNode::order));
    }
};
constexpr auto enumerators(ManageNode::Order) {
    return std::to_array<std::string_view>({"release", "drain"});
}

// A status with hundreds of nodes comes in pages: each request asks for the nodes after the last one received.
struct StatusRequest {
    NodeId after;  // 0: from the first
    static constexpr auto describe(auto row) { return std::tuple(row(1, "after", &StatusRequest::after)); }
};
struct StatusReply {
    session::ClusterStatus status;
    bool more = false;  // there are more nodes than fitted
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "status", &StatusReply::status), row(2, "more", &StatusReply::more));
    }
};

}  // namespace tessera::wire
