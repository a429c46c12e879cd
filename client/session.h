#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <variant>
#include <vector>

#include "client/job.h"
#include "mediator/base/error.h"
#include "mediator/scene/blob.h"
#include "mediator/scene/change_list.h"

namespace tessera::net {
class Channel;
}

namespace tessera::client {

struct SessionSettings {
    std::string name = "client", host, software = "tessera";
    std::uint64_t pid = 0;
    Duration connect_limit = std::chrono::seconds(10);  // until the first welcome
    Duration lost_limit =
        std::chrono::seconds(30);  // of silence after it, while reconnecting; and of a delivery
    Duration heartbeat = std::chrono::seconds(1);  // until the master's welcome tells its own
    // A master that says goodbye may be started anew: the connection is tried again, up to `lost_limit`.
    bool returns = false;
    bool mirrors_scene = true;  // of a live scene; else LiveSession::scene() stays empty until a refresh
};

// Where a cluster is, and who we are to it.
struct Address {
    std::string endpoint;         // "tcp://host:port"
    std::string keys;             // folder or exported file; "" = not encrypted
    std::string user = "editor";  // whose pair in that folder
};

struct OpenedScene {
    Version version;
    ObjectId first_id, end_id;  // new objects take their ids from [first, end); the Root is there already
};

struct SubmitResult {
    bool accepted = false;
    Version version;                    // that holds the edit
    std::vector<std::string> problems;  // why not
};

enum class WhenBusy { Queue, GiveUp };
struct Busy {
    std::string reason;
};
struct Stopped {};
using OpenOutcome = std::variant<OpenedScene, Busy, Stopped>;

// One client of a master. A thread of its own keeps the link, its heartbeats and the blobs that the master
// asks for, so the caller may be away for long. The calls below come from one thread and block. They throw
// Error{Unavailable} when the master does not answer, is gone or has lost this session, and Error{Refused}
// when it says no. A short break of the connection is bridged by itself. The destructor says goodbye; a scene
// leaves the master with its client.
class Session {
  public:
    // Over a channel of any kind, of which it is the client end; `reconnect` makes new sockets behind it, may
    // be empty, and is called on the session's thread. `blobs` holds whatever edits refer to.
    Session(std::unique_ptr<net::Channel> channel, std::function<void()> reconnect,
            std::shared_ptr<scene::BlobStore> blobs, const Clock& clock, SessionSettings settings);
    ~Session();

    // Waits for the stage. `on_place` hears the place in the queue, 1 = next. Busy only with GiveUp.
    OpenOutcome open_scene(const std::string& title, WhenBusy when_busy,
                           const std::function<void(std::uint32_t place)>& on_place, std::stop_token stop);

    // Returns when the master holds the edit and all its blobs. Nothing when stopped before.
    std::optional<SubmitResult> submit(std::vector<scene::Entry> entries, std::stop_token stop);

    // Returns with the film. A stop asks the master for what is merged so far.
    JobResult render(const JobRequest& request, const std::function<void(const Progress&)>& on_progress,
                     std::stop_token stop);

    ClusterStatus status();

    // Where the time of the latest edits of the live scene went, oldest first.
    wire::Trace trace(std::uint32_t count);

    // Another filter for the frame that is being rendered, whoever asked for it; what the master answers.
    // Throws Error{Refused} with the master's reason.
    std::string set_filter(const std::string& filter);

  private:
    struct Implementation;
    std::unique_ptr<Implementation> implementation_;
};

// A session over TCP. Throws Error for keys that cannot be used.
std::unique_ptr<Session> connect(const Address& address, std::shared_ptr<scene::BlobStore> blobs,
                                 const Clock& clock, const SessionSettings& settings);

}  // namespace tessera::client
