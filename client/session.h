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
#include "mediator/session/people.h"
#include "mediator/session/status.h"
#include "mediator/session/view_request.h"
#include "mediator/session/view_summary.h"

namespace tessera::client {

struct SessionSettings {
    std::string name = "client", host, software = "tessera";
    std::uint64_t pid = 0;
    Duration connect_limit = std::chrono::seconds(10);  // until the first welcome
    Duration lost_limit =
        std::chrono::seconds(30);  // of silence after it, while reconnecting; and of a delivery
    Duration heartbeat = std::chrono::seconds(1);  // until the master's welcome tells its own
    bool mirrors_scene = true;  // of a shared scene; else scene() stays empty until a refresh
    // Hears, on the caller's thread, when the connection is lost and tried again, and when it is back.
    std::function<void(bool is_away)> on_away = {};
};

// Where a cluster is, and who we are to it.
struct Address {
    std::string endpoint;         // "tcp://host:port"
    std::string keys;             // folder or exported file; "" = not encrypted
    std::string user = "editor";  // whose pair in that folder
};

enum class WhenBusy { Queue, GiveUp };
struct JoinRequest {
    std::string title;       // of a scene that is opened; one that is there keeps its own
    bool exclusive = false;  // a scene of this client alone, which goes with it
    WhenBusy when_busy = WhenBusy::Queue;
    std::function<void(std::uint32_t place)> on_place = {};  // hears the place in the queue; 1 = next
};
struct Joined {
    std::string title, name;  // as the master has them
    Version version;
    ObjectId first_id, end_id;  // new objects take their ids from [first, end); the Root is there already
};
struct Busy {
    std::string reason;
};
struct Stopped {};
using JoinOutcome = std::variant<Joined, Busy, Stopped>;  // Busy only with GiveUp

// One client of a master: a member of a scene, which it edits, views and displays. A thread of its own keeps the
// link, its heartbeats and the blobs that the master asks for, so the caller may be away for long; the calls
// below come from one thread. They throw Error{Unavailable} when the master is gone for longer than the settings
// allow, Error{Refused} when it says no. A break of the connection is bridged by itself, also when the master
// was started anew: the session joins again under its key, sends again what was not answered and requests its
// views again. An exclusive scene that the master has lost is an Error{Unavailable}.
class Session {
  public:
    struct Implementation;
    explicit Session(std::unique_ptr<Implementation> implementation);  // see connect(), make_session()
    ~Session();                                                        // says goodbye

    JoinOutcome join(const JoinRequest& request, std::stop_token stop);
    void close_scene();  // for everybody

    // ---- scene ----
    // As of the last refresh(), which brings all edits that were answered before.
    const scene::Scene& scene() const;
    void refresh();
    ObjectId new_id();
    scene::BlobPtr fetch(const scene::BlobRef& blob);  // from the store, else from the master

    // All entries are one transaction, or refused. Edits in a row with the same gesture, not 0, are one, too.
    session::EditResult submit(std::vector<scene::Entry> entries, std::uint64_t gesture = 0);
    // Without waiting for the answer, but not further ahead than 256 edits. take_results() brings the answers
    // in order, those there are; settle() waits until none is missing: false when it was stopped before.
    void submit_ahead(std::vector<scene::Entry> entries, std::uint64_t gesture = 0);
    std::vector<session::EditResult> take_results();
    bool settle(std::stop_token stop = {});
    session::EditResult undo(std::uint64_t transaction = scene::UndoLatest);
    session::EditResult redo() { return undo(scene::RedoLatest); }

    void lock(const std::vector<ObjectId>& objects);
    void unlock(const std::vector<ObjectId>& objects);
    void set_presence(const std::string& text, const std::vector<ObjectId>& selection, Duration time_to_live);
    session::People people();
    std::vector<session::TransactionSummary> history(std::uint32_t count);
    std::vector<session::FieldWriter> writers(ObjectId object);
    // Where the time of the latest edits went, oldest first.
    std::vector<session::EditTrace> trace(std::uint32_t count);

    // ---- views; `number` is the caller's ----
    // Again with the same number: other values, the latest wins.
    void request_view(std::uint64_t number, const session::ViewRequest& request);
    // Watches the view that has this name; of the request, what is delivered means something.
    void share_view(std::uint64_t number, const session::ViewRequest& request);
    void look(std::uint64_t number, const view::CameraPose& camera);  // of a view of ours; does not wait
    void stop_view(std::uint64_t number);   // its last frame comes, with what there is
    void close_view(std::uint64_t number);  // no more of it
    // The newest frame that has come, and tells the master to send the next one.
    std::optional<Frame> next_frame(TimePoint deadline, std::stop_token stop);
    // Its latest news; nothing when there are none since the last call.
    std::optional<session::ViewProgress> take_progress(std::uint64_t number);
    // What became of a view that its stop rule has ended, once.
    std::optional<session::ViewSummary> take_summary(std::uint64_t number);
    // Waits for the end of a view and closes it; a stop asks for what there is. See client/render.h.
    ViewResult wait_for_end(std::uint64_t number,
                            const std::function<void(const session::ViewProgress&)>& on_progress,
                            std::stop_token stop);
    // Another filter for the view of that name, whoever requested it; "" = the one that there is. Returns what it
    // means for the frame.
    std::string set_filter(const std::string& view, const std::string& filter);
    // What the master had to say since the last call: that a view waits for nodes, or cannot be rendered.
    std::vector<std::string> take_notices();
    session::Picked pick(std::uint64_t number, std::uint32_t x, std::uint32_t y);

    // ---- the display in front of the scene ----
    // Its description and arrays go through the session's blob store.
    void open_display(const display::Display& display);
    void close_display();
    void adjust_display(const session::DisplayAdjustment& adjustment);
    void move_head(const display::Head& head);  // the latest wins; does not wait
    // Shows an output of it from now on, also after a break: next_output_event() brings what is to be done.
    void join_output(const std::string& name);
    std::optional<OutputEvent> next_output_event(TimePoint deadline, std::stop_token stop);
    void output_ready(std::uint64_t frame);

    // ---- jobs: views that were requested as detached; of this user, for operators of all ----
    std::vector<session::JobStatus> jobs();
    // The end of one: its picture and what became of it. Error{Refused} while it is being rendered.
    ViewResult fetch_job(const session::JobName& job);
    void cancel_job(const session::JobName& job);  // ends it, and forgets its picture

    session::ClusterStatus status();

    // Takes in what has come, so that an idle caller notices an end of the link; next_frame() does it, too.
    void pump();

  private:
    std::unique_ptr<Implementation> implementation_;
};

// A session over TCP. Throws Error for keys that cannot be used.
std::unique_ptr<Session> connect(const Address& address, std::shared_ptr<scene::BlobStore> blobs,
                                 const Clock& clock, const SessionSettings& settings);

}  // namespace tessera::client
