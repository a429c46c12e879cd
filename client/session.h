#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <variant>
#include <vector>

#include "client/frame.h"
#include "client/output_event.h"
#include "mediator/base/clock.h"
#include "mediator/base/error.h"
#include "mediator/display/display.h"
#include "mediator/scene/blob.h"
#include "mediator/scene/change_list.h"
#include "mediator/scene/scene.h"
#include "mediator/session/display.h"
#include "mediator/session/edits.h"
#include "mediator/session/jobs.h"
#include "mediator/session/members.h"
#include "mediator/session/status.h"
#include "mediator/session/view_request.h"
#include "mediator/session/view_summary.h"

namespace tessera::client {

struct SessionSettings {
    std::string name = "client", host, software = "tessera";
    std::uint64_t pid = 0;
    Duration connect_limit = std::chrono::seconds(10);  // until the first welcome
    Duration lost_limit =
        std::chrono::seconds(30);  // later: without a message while reconnecting or waiting for a delivery
    Duration heartbeat = std::chrono::seconds(1);  // until the master's welcome sets it
    // Requested: waiting for a master that is not there, or has fallen silent, ends with Error{Unavailable}.
    std::stop_token stop = {};
    bool mirrors_scene = true;  // mirror live scenes on join; otherwise scene() is empty until a refresh
    // Called on the caller's thread when the connection is lost (and being re-established) and when it is back.
    std::function<void(bool is_away)> on_away = {};
};

// The endpoint of a cluster and the key to use.
struct Address {
    std::string endpoint;         // "tcp://host:port"
    std::string keys;             // folder or exported file; "" = not encrypted
    std::string user = "editor";  // name of the key pair in that folder
};

// Film of an earlier view, as ViewResult::frame.film_state has it, and where it is from.
struct EarlierFilm {
    frame::FilmState film;
    Hash128 scene_hash;                 // as in its ViewSummary
    std::uint32_t render_revision = 0;  // of the build that rendered it
    std::string kind;  // of the nodes that rendered it, for a view that is to be reproducible
};

enum class WhenBusy { Queue, GiveUp };
struct JoinRequest {
    std::string title;       // of the scene, if it is opened by this join
    bool exclusive = false;  // a scene for this client only, closed when it leaves
    WhenBusy when_busy = WhenBusy::Queue;
    std::function<void(std::uint32_t place)> on_place = {};  // called with the queue position; 1 = next
};
struct Joined {
    std::string title, name;  // as assigned by the master
    Version version;
    ObjectId first_id, end_id;  // ids for new objects: [first, end); the Root exists already
};
struct Busy {
    std::string reason;
};
struct Stopped {};
using JoinOutcome = std::variant<Joined, Busy, Stopped>;  // Busy only with GiveUp

// A client of a master: a member of a scene, which it edits, views and displays. A background thread handles the
// link, heartbeats and blob requests of the master; the calls below must come from one thread. They throw
// Error{Unavailable} if the master is unreachable for longer than the settings allow, Error{Refused} if it rejects a
// request. Interruptions are recovered automatically, including a restart of the master: the session joins again
// under its key, resends unanswered messages and requests its views again. If the master has lost an exclusive scene,
// calls throw Error{Unavailable}.
class Session {
  public:
    struct Implementation;
    explicit Session(std::unique_ptr<Implementation> implementation);  // see connect(), make_session()
    ~Session();                                                        // says goodbye

    JoinOutcome join(const JoinRequest& request, std::stop_token stop);
    void close_scene();  // for all members

    // ---- scene ----
    // As of the last refresh(), which includes all edits answered before it.
    const scene::Scene& scene() const;
    void refresh();
    ObjectId new_id();
    scene::BlobPtr fetch(const scene::BlobRef& blob);  // from the store, else from the master

    // All entries are one transaction, or rejected. Consecutive edits with the same edit_group, not 0, are one, too.
    session::EditResult submit(std::vector<scene::Entry> entries, std::uint64_t edit_group = 0);
    // Does not wait for the answer; at most 256 edits may be unanswered. take_results() returns the answers received
    // so far, in order; settle() waits for all of them, and returns false if it was stopped.
    void submit_ahead(std::vector<scene::Entry> entries, std::uint64_t edit_group = 0);
    std::vector<session::EditResult> take_results();
    bool settle(std::stop_token stop = {});
    session::EditResult undo(std::uint64_t transaction = scene::UndoLatest);
    session::EditResult redo() { return undo(scene::RedoLatest); }

    void lock(const std::vector<ObjectId>& objects);
    void unlock(const std::vector<ObjectId>& objects);
    void set_presence(const std::string& text, const std::vector<ObjectId>& selection, Duration time_to_live);
    session::Members members();
    std::vector<session::TransactionSummary> history(std::uint32_t count);
    std::vector<session::FieldWriter> writers(ObjectId object);
    // Latency traces of the latest edits, oldest first.
    std::vector<session::EditTrace> trace(std::uint32_t count);

    // ---- views; `number` is chosen by the caller ----
    // A request with the same number replaces the earlier one.
    void request_view(std::uint64_t number, const session::ViewRequest& request);
    // As request_view(), of a view that is new: it goes on with this film. Throws Error{Refused} if that shows another
    // scene or has other tiles, channels or samples than the view would have.
    void continue_view(std::uint64_t number, const session::ViewRequest& request, const EarlierFilm& earlier);
    // Watches the existing view with this name; only the delivery settings of the request are used.
    void share_view(std::uint64_t number, const session::ViewRequest& request);
    // Of a view requested by this session; asynchronous.
    void set_camera(std::uint64_t number, const view::CameraPose& camera);
    void stop_view(std::uint64_t number);   // ends rendering; the last frame is delivered
    void close_view(std::uint64_t number);  // discards the view
    // The newest frame received; acknowledges it, so that the master sends the next one.
    std::optional<Frame> next_frame(TimePoint deadline, std::stop_token stop);
    // The newest frame of this view, if one has been received; acknowledges it likewise.
    std::optional<Frame> take_frame(std::uint64_t number);
    // The latest progress, if any since the last call.
    std::optional<session::ViewProgress> take_progress(std::uint64_t number);
    // The summary of a view that has ended; returned once.
    std::optional<session::ViewSummary> take_summary(std::uint64_t number);
    // Waits for the end of a view; a stop requests the samples merged so far. Then closes it, or keeps it with the history
    // of its denoiser, to be requested again under its number. See client/render.h.
    enum class AfterEnd { Close, Keep };
    ViewResult wait_for_end(std::uint64_t number,
                            const std::function<void(const session::ViewProgress&)>& on_progress,
                            std::stop_token stop, AfterEnd after = AfterEnd::Close);
    // Changes the filter of the view with this name; "" = the only view that this key may change. Returns a
    // description of the effect. Throws Error{Refused} for another's view, unless this key is an operator's.
    std::string set_filter(const std::string& view, const std::string& filter);
    // Notices of the master since the last call: e.g. that a view waits for nodes, or cannot be rendered.
    std::vector<std::string> take_notices();
    session::PickResult pick(std::uint64_t number, std::uint32_t x, std::uint32_t y);

    // ---- the display of the scene ----
    // Its description and arrays are transferred as blobs.
    void open_display(const display::Display& display);
    void close_display();
    void adjust_display(const session::DisplayAdjustment& adjustment);
    void move_head(const display::Head& head);  // asynchronous; the latest position is used
    // Makes this client show an output, also after reconnecting; next_output_event() returns its frames and orders.
    void join_output(const std::string& name);
    std::optional<OutputEvent> next_output_event(TimePoint deadline, std::stop_token stop);
    void output_ready(std::uint64_t frame);

    // ---- jobs: views requested as detached, of this user; operators see those of all users ----
    std::vector<session::JobStatus> jobs();
    // The picture and summary of a finished job. Error{Refused} while it is being rendered.
    ViewResult fetch_job(const session::JobName& job);
    void cancel_job(const session::JobName& job);  // stops it and deletes its picture

    session::ClusterStatus status();
    // For operators, about all nodes of that name: ends their quarantine; or makes them finish and leave.
    void release_node(const std::string& name);
    void drain_node(const std::string& name);

    // Processes received messages, so that an idle caller notices a lost link. next_frame() does so as well.
    void pump();

  private:
    std::unique_ptr<Implementation> implementation_;
};

// A session over TCP. Throws Error for keys that cannot be used.
std::unique_ptr<Session> connect(const Address& address, std::shared_ptr<scene::BlobStore> blobs,
                                 const Clock& clock, const SessionSettings& settings);

}  // namespace tessera::client
