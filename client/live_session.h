#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "client/output_event.h"
#include "client/session.h"
#include "mediator/display/display.h"
#include "mediator/frame/film_tile.h"
#include "mediator/scene/scene.h"
#include "mediator/view/view.h"
#include "mediator/wire/live_messages.h"

namespace tessera::client {

struct Joined {
    std::string title, name;  // as the master has them
};
using JoinOutcome = std::variant<Joined, Busy, Stopped>;

struct EditResult {
    bool accepted = false;
    Version version;                    // that holds it, or will
    std::vector<std::string> problems;  // why not
    std::uint64_t transaction = 0;
    std::vector<std::string> notes;  // of an undo: what was left as others made it
};

struct LiveViewRequest {
    view::View view;  // id and revision are the master's to choose
    std::uint64_t spp = 64;
    wire::PictureEncoding picture = wire::PictureEncoding::None;
    bool film = false;   // statistics, too
    std::string name;    // for others; "" = the master's choice
    bool share = false;  // watch the view of that name; `view` and `spp` mean nothing
};

// A frame of a view, as the master had it when it was sent.
struct Frame {
    std::uint64_t view = 0, number = 0;
    Version version;
    std::uint64_t revision = 0;  // of the view: grows with every change of its camera
    std::uint32_t scale = 1;     // 8, 4, 2: a coarse picture of this part of the view's size
    std::uint32_t width = 0, height = 0, components = 0;
    wire::PictureEncoding encoding = wire::PictureEncoding::None;
    std::vector<std::byte> picture;       // Planes: float32, one component after another
    std::optional<frame::FilmTile> film;  // of the whole window
    std::uint64_t samples_least = 0, samples_most = 0, spp = 0;
    bool complete = false;
    Hash256 film_hash;  // when complete
};

// A member of a live scene. A thread of its own keeps the link, so the caller may be away for long; the calls
// below come from one thread. They throw Error{Unavailable} when the master is gone for longer than the
// settings allow, Error{Refused} when it says no. A break of the connection is bridged by itself, also when
// the master was started anew: the session joins again under its key, sends again what was not answered and
// opens its views again.
class LiveSession {
  public:
    LiveSession(std::unique_ptr<net::Channel> channel, std::function<void()> reconnect,
                std::shared_ptr<scene::BlobStore> blobs, const Clock& clock, SessionSettings settings);
    ~LiveSession();  // says goodbye

    JoinOutcome join(const std::string& title, WhenBusy when_busy,
                     const std::function<void(std::uint32_t place)>& on_place, std::stop_token stop);
    void close_scene();  // for everybody

    // The scene as of the last refresh(), which brings all edits that were answered before.
    const scene::Scene& scene() const;
    void refresh();
    ObjectId new_id();
    scene::BlobPtr fetch(const scene::BlobRef& blob);  // from the store, else from the master

    // All entries are one transaction, or refused. Edits in a row with the same gesture, not 0, are one, too.
    EditResult submit(std::vector<scene::Entry> entries, std::uint64_t gesture = 0);
    // Without waiting for the answer, but not further ahead than 256 edits. take_results() brings the answers
    // in order, those there are; settle() waits until none is missing.
    void submit_ahead(std::vector<scene::Entry> entries, std::uint64_t gesture = 0);
    std::vector<EditResult> take_results();
    void settle();
    EditResult undo(std::uint64_t transaction = scene::UndoLatest);
    EditResult redo() { return undo(scene::RedoLatest); }

    void lock(const std::vector<ObjectId>& objects);
    void unlock(const std::vector<ObjectId>& objects);
    void set_presence(const std::string& text, const std::vector<ObjectId>& selection, Duration time_to_live);
    wire::People people();
    std::vector<wire::TransactionSummary> history(std::uint32_t count);
    std::vector<wire::FieldWriter> writers(ObjectId object);
    std::vector<wire::EditTrace> trace(std::uint32_t count);

    // `number` is the caller's; again with the same one: other values, the latest wins.
    void open_view(std::uint64_t number, const LiveViewRequest& request);
    void look(std::uint64_t number, const view::CameraPose& camera);  // of a view of ours; does not wait
    void close_view(std::uint64_t number);
    // The newest frame that has come, and tells the master to send the next one.
    std::optional<Frame> next_frame(TimePoint deadline, std::stop_token stop);
    // What the master had to say since the last call: that a view waits for nodes, or cannot be rendered.
    std::vector<std::string> take_notices();
    wire::Picked pick(std::uint64_t number, std::uint32_t x, std::uint32_t y);

    // The display in front of the live scene. Its description and arrays go through the session's blob store.
    void open_display(const display::Display& display);
    void close_display();
    void adjust_display(const wire::AdjustDisplay& adjustment);
    void move_head(const display::Head& head);  // the latest wins; does not wait
    // Shows an output of it from now on, also after a break: next_output_event() brings what is to be done.
    void join_output(const std::string& name);
    std::optional<OutputEvent> next_output_event(TimePoint deadline, std::stop_token stop);
    void output_ready(std::uint64_t frame);

    // Takes in what has come, so that an idle caller notices an end of the link; next_frame() does it, too.
    void pump();

  private:
    struct Implementation;
    std::unique_ptr<Implementation> implementation_;
};

// Over TCP. Throws Error for keys that cannot be used.
std::unique_ptr<LiveSession> connect_live(const Address& address, std::shared_ptr<scene::BlobStore> blobs,
                                          const Clock& clock, const SessionSettings& settings);

}  // namespace tessera::client
