#pragma once

#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "master/peers/outbox.h"
#include "master/peers/session_table.h"
#include "master/render/film_merger.h"
#include "master/render/live_view.h"

namespace tessera::master {

// Who watches which view, and the frames on their way. A watcher has one frame on its way at a time; when it
// is taken, the newest follows, so a slow or stopped watcher costs one frame and delays nobody. Watchers that
// want the same get the same bytes.
class FrameSender {
  public:
    FrameSender(SessionTable& sessions, Outbox& outbox, FilmMerger& merger)
        : sessions_(sessions), outbox_(outbox), merger_(merger) {}

    struct Wish {
        wire::PictureEncoding picture = wire::PictureEncoding::None;
        bool film = false;
        friend auto operator<=>(const Wish&, const Wish&) = default;
    };
    void watch(SessionId session, std::uint64_t number, ViewId view, const Wish& wish);
    void leave(SessionId session, std::uint64_t number);
    void leave_all(SessionId session);
    void taken(SessionId session, const wire::FrameTaken& taken);
    void resumed(SessionId session);  // what was on its way may be lost: the newest goes again
    void forget(ViewId view);         // closed: nobody watches it any more

    std::optional<ViewId> watched(SessionId session, std::uint64_t number) const;
    std::uint64_t watchers(ViewId view) const;
    std::vector<std::uint64_t> numbers(SessionId session) const;

    // Has frames made of what `live` shows, for those who are free and have not seen it. Not more often than
    // `interval` within a pass, nor so often that more than a quarter of the time goes into making them.
    void offer(LiveView& live, TimePoint now, Duration interval);
    // From the merger; true when it was one of ours.
    bool take(EncodedTile&& tile);
    bool take(Reconstructed&& made, TimePoint now);

  private:
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
        wire::LiveFrame header;
        std::vector<net::Bytes> tiles;
        std::vector<Key> receivers;
    };
    void send(std::uint64_t frame, Making&& making, const Reconstructed& made);

    SessionTable& sessions_;
    Outbox& outbox_;
    FilmMerger& merger_;
    std::map<Key, Watcher> watchers_;
    std::map<std::uint64_t, Making> making_;  // by frame
    struct Made {
        TimePoint started{};
        Duration cost{};  // of the latest
        std::optional<Shown> shown;
    };
    std::map<std::pair<ViewId, Wish>, Made> made_;
    std::uint64_t next_frame_ = 1;
};

}  // namespace tessera::master
