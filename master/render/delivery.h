#pragma once

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

// Who gets the pictures of which view, and the frames on their way. A watcher has one frame on its way at a
// time; when it is taken, the newest follows, so a slow or stopped watcher costs one frame and delays nobody.
// Watchers that want the same get the same bytes. Who waits for the end gets the last picture, and what
// became of the view.
class Delivery {
  public:
    Delivery(const ViewTable& views, SessionTable& sessions, Outbox& outbox, FilmStore& film)
        : views_(views), sessions_(sessions), outbox_(outbox), film_(film) {}

    struct Wish {
        session::PictureEncoding picture = session::PictureEncoding::None;
        bool film = false;
        session::Frames frames = session::Frames::All;
        view::DisplayTransform transform;
        friend auto operator<=>(const Wish&, const Wish&) = default;
    };
    void watch(SessionId session, std::uint64_t number, ViewId view, const Wish& wish);
    void leave(SessionId session, std::uint64_t number);
    void taken(SessionId session, const wire::FrameTaken& taken);
    void resumed(SessionId session);  // what was on its way may be lost: it goes again
    void forget(ViewId view);         // closed: nobody watches it any more

    // The end of a view that is kept for whoever comes for it.
    struct Ended {
        ViewId view;
        wire::FrameHeader header;
        session::ViewSummary summary;
        std::shared_ptr<const std::vector<std::byte>> picture;  // never null
    };
    void keep(ViewId view, const Wish& wish) { watch(Keeper, view.value, view, wish); }
    void release(ViewId view) { leave(Keeper, view.value); }
    bool is_kept(ViewId view) const { return watched(Keeper, view.value).has_value(); }
    std::vector<Ended> take_ended() { return std::exchange(ended_, {}); }
    // Sends a picture that was kept, as the end of the session's view of that number.
    void send_kept(const SessionRecord& session, Ended kept);
    std::size_t on_their_way(SessionId session) const;  // shipments

    std::optional<ViewId> watched(SessionId session, std::uint64_t number) const;
    std::uint64_t watchers(ViewId view) const;
    std::vector<std::uint64_t> numbers(SessionId session) const;

    // Has frames made of what the view shows, for those who are free and have not seen it. Not more often than
    // `interval` within a pass, nor so often that more than a quarter of the time goes into making them.
    void offer(const ViewState& view, TimePoint now, Duration interval);
    // Where the view is, for those who wait for its end.
    void report_progress(const ViewState& view, std::uint32_t nodes);
    // Film or picture of frames that are being made has come.
    void take(EncodedTile&& tile);
    void take(const Reconstructed& made, TimePoint now);
    std::optional<ViewId> ends(std::uint64_t frame) const;  // the view whose end the frame shows
    // Sends what is made to those whose links have room.
    void send();

  private:
    static constexpr SessionId Keeper{0};  // of no client
    using Key = std::pair<SessionId, std::uint64_t>;
    struct Watcher {
        ViewId view;
        Wish wish;
        std::uint64_t on_its_way = 0;  // frame; 0 = free
        std::optional<Shown> seen;     // the latest sent, and of which version: a change that no picture
        Version seen_version;          // shows is told with the same picture, for those who wait for it
    };
    struct Making {
        ViewId view;
        Wish wish;
        Shown shown;
        wire::FrameHeader header;
        bool is_end = false;
        std::deque<net::Bytes> tiles;
        ViewId film;  // of tiles that are made when there is room for them; 0: all are here
        std::vector<Key> receivers;
    };
    // A frame on its way to one watcher. A client collects one at a time: the next begins when it is sent.
    struct Shipment {
        Key to;
        ViewId view;
        std::uint64_t frame = 0;
        std::optional<wire::FrameHeader> header;  // goes first
        std::shared_ptr<const std::vector<std::byte>> picture;
        std::size_t picture_sent = 0;
        std::deque<net::Bytes> tiles;
        std::uint32_t tile_count = 0, tiles_requested = 0, tiles_sent = 0;
        ViewId film;
        bool is_done() const { return picture_sent == picture->size() && tiles_sent == tile_count; }
    };
    Making frame_of(const ViewState& view, const Wish& wish, std::uint64_t frame) const;
    void begin(const ViewState& view, const Wish& wish, std::vector<Key> receivers);
    void ship(std::uint64_t frame, Making&& making, const Reconstructed& made);
    session::ViewSummary end_of(const ViewState& view, const Reconstructed& made) const;
    void send(Shipment& shipment, const SessionRecord& session);

    const ViewTable& views_;
    SessionTable& sessions_;
    Outbox& outbox_;
    FilmStore& film_;
    std::map<Key, Watcher> watchers_;
    std::map<std::uint64_t, Making> making_;  // by frame
    std::list<Shipment> shipments_;
    std::vector<Ended> ended_;
    struct Made {
        TimePoint started{};
        Duration cost{};  // of the latest
        std::optional<Shown> shown;
    };
    std::map<std::pair<ViewId, Wish>, Made> made_;
    std::uint64_t next_frame_ = 1;
};

}  // namespace tessera::master
