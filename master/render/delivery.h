#pragma once

#include <array>
#include <deque>
#include <list>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "master/peers/outbox.h"
#include "master/peers/session_table.h"
#include "master/render/film_store.h"
#include "master/render/view_table.h"

namespace tessera::master {

// Which watcher gets the pictures of which view, and the frames in flight. A watcher has at most one frame in
// flight; when it acknowledges it, the newest one follows, so a slow or stopped watcher costs one frame and
// delays no other. Watchers with the same format share the encoded bytes. A watcher that waits for the end gets
// the last picture and the view's summary.
class Delivery {
  public:
    Delivery(const ViewTable& views, SessionTable& sessions, Outbox& outbox, FilmStore& film)
        : views_(views), sessions_(sessions), outbox_(outbox), film_(film) {}

    struct FrameFormat {
        session::PictureEncoding picture = session::PictureEncoding::None;
        bool film = false, film_state = false;
        session::Frames frames = session::Frames::All;
        view::DisplayTransform transform;
        friend auto operator<=>(const FrameFormat&, const FrameFormat&) = default;
    };
    void watch(SessionId session, std::uint64_t number, ViewId view, const FrameFormat& format);
    void leave(SessionId session, std::uint64_t number);
    void taken(SessionId session, const wire::FrameTaken& taken);
    void resumed(SessionId session);  // frames in flight may be lost: they are sent again
    void forget(ViewId view);         // closed: removes its watchers
    // Clients that have had a frame for longer than `limit` and have neither taken it nor received more of it since.
    // To be called regularly.
    std::vector<SessionId> stalled(TimePoint now, Duration limit);

    // The end of a view that is kept until a client fetches it.
    struct Ended {
        ViewId view;
        wire::FrameHeader header;
        session::ViewSummary summary;
        std::shared_ptr<const std::vector<std::byte>> picture;  // never null
    };
    void keep(ViewId view, const FrameFormat& format) { watch(Keeper, view.value, view, format); }
    void release(ViewId view) { leave(Keeper, view.value); }
    bool is_kept(ViewId view) const { return watched(Keeper, view.value).has_value(); }
    std::vector<Ended> take_ended() { return std::exchange(ended_, {}); }
    // Sends a kept picture as the end of the session's view with that number.
    void send_kept(const SessionRecord& session, Ended kept);
    std::size_t in_flight(SessionId session) const;  // shipments

    std::optional<ViewId> watched(SessionId session, std::uint64_t number) const;
    std::uint64_t watchers(ViewId view) const;
    bool has_taken_end(SessionId session, std::uint64_t number) const;  // and acknowledged it
    std::vector<std::uint64_t> numbers(SessionId session) const;

    // Starts frames of the displayed state for watchers that have no frame in flight and have not seen it. At
    // most one per `interval` within a pass, and at most a quarter of the time is spent on reconstruction.
    void send_frames(const ViewState& view, TimePoint now, Duration interval);
    // Sends the view's progress to watchers that wait for its end.
    void report_progress(const ViewState& view, std::uint32_t nodes);
    // Film tiles or the picture of a pending frame are available.
    void take(EncodedTile&& tile);
    void take(const Reconstructed& made, TimePoint now);
    std::optional<ViewId> ends(std::uint64_t frame) const;  // the view whose end the frame shows
    // Sends finished frames over links that have room in their send queues, a few MiB at a time.
    void send();
    bool has_more() const { return has_more_; }  // that send() could have sent

  private:
    static constexpr SessionId Keeper{0};  // of no client
    using Key = std::pair<SessionId, std::uint64_t>;
    struct Watcher {
        ViewId view;
        FrameFormat format;
        std::uint64_t frame_in_flight = 0;   // 0 = none
        std::optional<DisplayedState> seen;  // the latest sent, and its scene version: after a
        Version
            seen_version;  // change that alters no pixel the same picture is sent again with the new version
        // Of the frame in flight: its number, what was sent of it, what waits for the link.
        std::array<std::uint64_t, 3> progress{};
        TimePoint progress_at{};
    };
    struct TileMessage {
        std::shared_ptr<net::Bytes> bytes;  // shared by the receivers of a frame
        bool ends_tile = true;
    };
    using EncodedTiles = std::deque<TileMessage>;
    struct PendingFrame {
        ViewId view;
        FrameFormat format;
        DisplayedState shown;
        wire::FrameHeader header;
        bool is_end = false;
        EncodedTiles tiles;
        ViewId film;  // its tiles are encoded as the link drains; 0: all are here
        std::vector<Key> receivers;
    };
    // A frame that is being sent to one watcher. A client receives one at a time: the next begins when it is sent.
    struct Shipment {
        Key to;
        ViewId view;
        std::uint64_t frame = 0;
        std::optional<wire::FrameHeader> header;  // goes first
        std::shared_ptr<const std::vector<std::byte>> picture;
        std::size_t picture_sent = 0;
        EncodedTiles tiles;
        std::uint32_t tile_count = 0, tiles_requested = 0, tiles_sent = 0;
        ViewId film;
        FilmStore::TilesAs form = FilmStore::TilesAs::Merged;
        bool is_done() const { return picture_sent == picture->size() && tiles_sent == tile_count; }
    };
    PendingFrame frame_of(const ViewState& view, const FrameFormat& format, std::uint64_t frame) const;
    void begin(const ViewState& view, const FrameFormat& format, std::vector<Key> receivers);
    void ship(std::uint64_t frame, PendingFrame&& pending, const Reconstructed& made);
    session::ViewSummary end_of(const ViewState& view, const Reconstructed& made) const;
    void send(Shipment& shipment, const SessionRecord& session, std::size_t& budget);

    const ViewTable& views_;
    SessionTable& sessions_;
    Outbox& outbox_;
    FilmStore& film_;
    std::map<Key, Watcher> watchers_;
    std::map<std::uint64_t, PendingFrame> pending_;  // by frame
    std::list<Shipment> shipments_;
    SessionId served_last_;  // whose shipment used up what may be sent at a time
    bool has_more_ = false;
    std::vector<Ended> ended_;
    struct FrameCost {
        TimePoint started{};
        Duration cost{};  // of the latest frame
        std::optional<DisplayedState> shown;
    };
    std::map<std::pair<ViewId, FrameFormat>, FrameCost> costs_;
    std::uint64_t next_frame_ = 1;
};

// What the client that opens the view receives.
Delivery::FrameFormat format_of(const session::ViewRequest& request);

}  // namespace tessera::master
