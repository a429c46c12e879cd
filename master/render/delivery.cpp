#include "master/render/delivery.h"

#include <algorithm>
#include <iterator>

#include "master/render/picture_chunks.h"
#include "master/render/view_summary.h"

namespace tessera::master {

namespace {
constexpr std::uint32_t TilesAhead = 32;                    // encoded by the film store and not yet sent
constexpr std::size_t BytesAhead = std::size_t{32} << 20;   // waiting for a slow client
constexpr std::size_t BytesAtATime = std::size_t{4} << 20;  // to all clients, in a step: about 2 ms

std::vector<Rect> tiles_without_samples(const ViewState& view) {
    std::vector<Rect> tiles;
    if (!view.is_last_pass()) return tiles;  // coarse pictures are replaced soon
    for (const session::FailedTile& tile : view.failed_tiles) {
        if (tile.samples == 0) tiles.push_back(tile.rect);
    }
    return tiles;
}

}  // namespace

void Delivery::watch(SessionId session, std::uint64_t number, ViewId view, const FrameFormat& format) {
    Watcher& watcher = watchers_[{session, number}];
    if (watcher.view != view || watcher.format != format) watcher.seen.reset();
    watcher.view = view;
    watcher.format = format;
}

void Delivery::leave(SessionId session, std::uint64_t number) {
    const Key key{session, number};
    watchers_.erase(key);
    std::erase_if(shipments_, [&](const Shipment& shipment) { return shipment.to == key; });
}

void Delivery::taken(SessionId session, const wire::FrameTaken& taken) {
    const auto watcher = watchers_.find({session, taken.number});
    if (watcher != watchers_.end() && watcher->second.frame_in_flight == taken.frame)
        watcher->second.frame_in_flight = 0;
}

void Delivery::resumed(SessionId session) {
    for (auto& [key, watcher] : watchers_) {
        if (key.first != session) continue;
        watcher.frame_in_flight = 0;
        watcher.seen.reset();
    }
    std::erase_if(shipments_, [&](const Shipment& shipment) { return shipment.to.first == session; });
}

void Delivery::forget(ViewId view) {
    std::erase_if(watchers_, [&](const auto& entry) { return entry.second.view == view; });
    std::erase_if(pending_, [&](const auto& entry) { return entry.second.view == view; });
    std::erase_if(costs_, [&](const auto& entry) { return entry.first.first == view; });
    std::erase_if(shipments_, [&](const Shipment& shipment) { return shipment.view == view; });
}

std::vector<SessionId> Delivery::stalled(TimePoint now, Duration limit) {
    std::vector<SessionId> stalled;
    for (auto& [key, watcher] : watchers_) {
        const SessionRecord* session = sessions_.find(key.first);
        const bool is_made = watcher.frame_in_flight != 0 && !pending_.contains(watcher.frame_in_flight);
        if (session == nullptr || !is_made) {
            watcher.progress = {};
            continue;
        }
        std::array<std::uint64_t, 3> progress{
            watcher.frame_in_flight, 0,
            session->bulk ? outbox_.waiting_bytes(net::Link::Bulk, *session->bulk) : 0};
        for (const Shipment& shipment : shipments_) {
            if (shipment.to == key) progress[1] = shipment.picture_sent + shipment.tiles_sent;
        }
        if (watcher.progress != progress) {
            watcher.progress = progress;
            watcher.progress_at = now;
        }
        if (now - watcher.progress_at > limit) stalled.push_back(key.first);
    }
    return stalled;
}

std::optional<ViewId> Delivery::watched(SessionId session, std::uint64_t number) const {
    const auto watcher = watchers_.find({session, number});
    if (watcher == watchers_.end()) return std::nullopt;
    return watcher->second.view;
}

std::uint64_t Delivery::watchers(ViewId view) const {
    return static_cast<std::uint64_t>(std::count_if(
        watchers_.begin(), watchers_.end(), [&](const auto& entry) { return entry.second.view == view; }));
}

bool Delivery::has_taken_end(SessionId session, std::uint64_t number) const {
    const auto watcher = watchers_.find({session, number});
    return watcher != watchers_.end() && watcher->second.frame_in_flight == 0 && watcher->second.seen &&
           watcher->second.seen->complete;
}

std::vector<std::uint64_t> Delivery::numbers(SessionId session) const {
    std::vector<std::uint64_t> numbers;
    for (const auto& [key, watcher] : watchers_) {
        if (key.first == session) numbers.push_back(key.second);
    }
    return numbers;
}

void Delivery::send_frames(const ViewState& view, TimePoint now, Duration interval) {
    if (!view.shown || view.shown->revision != view.revision) return;
    const DisplayedState& shown = *view.shown;
    std::map<FrameFormat, std::vector<Key>> free;
    for (const auto& [key, watcher] : watchers_) {
        const bool has_seen = watcher.seen == shown && watcher.seen_version == view.version;
        if (watcher.view != view.id || watcher.frame_in_flight != 0 || has_seen) continue;
        const bool waits = watcher.format.frames == session::Frames::Last || view.passes.empty();
        if (waits && !shown.complete) continue;
        free[watcher.format].push_back(key);
    }
    for (auto& [format, receivers] : free) {
        const bool busy = std::any_of(pending_.begin(), pending_.end(), [&](const auto& entry) {
            return entry.second.view == view.id && entry.second.format == format;
        });
        FrameCost& last = costs_[{view.id, format}];
        const bool news = last.shown != shown &&
                          (shown.complete || shown.pass + 1 < view.passes.size() || shown.samples == 0);
        constexpr int CostLimit = 4;
        if (busy || (!news && now - last.started < std::max(interval, CostLimit * last.cost))) continue;
        last.started = now;
        last.shown = shown;
        begin(view, format, std::move(receivers));
    }
}

Delivery::PendingFrame Delivery::frame_of(const ViewState& view, const FrameFormat& format,
                                          std::uint64_t frame) const {
    PendingFrame pending{
        .view = view.id, .format = format, .shown = *view.shown, .header = {}, .tiles = {}, .receivers = {}};
    pending.header = {.frame = frame,
                      .version = view.version,
                      .revision = view.camera_revision,
                      .encoding = format.picture,
                      .spp = view.request.stop.spp,
                      .complete = view.shown->complete,
                      .noise = view.run.noise};
    pending.is_end = view.shown->complete && view.run.outcome.has_value();
    if (view.passes.empty()) return pending;
    const Pass& pass = view.passes[view.shown->pass];
    pending.header.scale = pass.scale;
    pending.header.width = static_cast<std::uint32_t>(pass.view.window.width);
    pending.header.height = static_cast<std::uint32_t>(pass.view.window.height);
    pending.header.mean_samples = double(view.shown->samples) / double(pass.view.window.pixel_count());
    return pending;
}

void Delivery::begin(const ViewState& view, const FrameFormat& format, std::vector<Key> receivers) {
    const std::uint64_t frame = next_frame_++;
    PendingFrame pending = frame_of(view, format, frame);
    for (const Key& key : receivers) watchers_.at(key).frame_in_flight = frame;
    pending.receivers = std::move(receivers);
    const bool waited = format.frames == session::Frames::Last;
    if (view.passes.empty()) return ship(frame, std::move(pending), {});
    const Pass& pass = view.passes[view.shown->pass];
    if (format.film) {
        pending.header.film_tiles = pass.tiles;
        pending.header.film_window = pass.view.window;
        if (waited) {
            pending.film = pass.view.id;  // nothing is added to it any more
        } else {
            film_.deliver(pass.view.id, frame, 0, pending.header.film_tiles);
        }
    }
    const bool nothing_to_make = waited ? !has_picture(view, format.picture) : view.run.samples == 0;
    if (pending.is_end && nothing_to_make) return ship(frame, std::move(pending), {});
    const bool hash = pending.shown.complete && !waited;
    film_.reconstruct(
        frame, pass.view, {view.version, views_.last_edits},
        {format.picture, format.transform, view.id, tiles_without_samples(view), view.request.view.window},
        hash ? FilmStore::FilmHash::Wanted : FilmStore::FilmHash::NotWanted);
    pending_.emplace(frame, std::move(pending));
}

void Delivery::report_progress(const ViewState& view, std::uint32_t nodes) {
    for (const auto& [key, watcher] : watchers_) {
        if (watcher.view != view.id || watcher.format.frames != session::Frames::Last) continue;
        if (const SessionRecord* session = sessions_.find(key.first))
            outbox_.control(session->control, wire::ViewProgress{key.second, progress_of(view, nodes)});
    }
}

void Delivery::take(EncodedTile&& tile) {
    if (const auto pending = pending_.find(tile.frame); pending != pending_.end()) {
        pending->second.tiles.push_back(
            {std::make_shared<net::Bytes>(std::move(tile.bytes)), tile.ends_tile});
        return;
    }
    for (Shipment& shipment : shipments_) {
        if (shipment.frame == tile.frame)
            return shipment.tiles.push_back(
                {std::make_shared<net::Bytes>(std::move(tile.bytes)), tile.ends_tile});
    }
}

std::optional<ViewId> Delivery::ends(std::uint64_t frame) const {
    const auto pending = pending_.find(frame);
    if (pending == pending_.end() || !pending->second.shown.complete) return std::nullopt;
    return pending->second.view;
}

void Delivery::take(const Reconstructed& made, TimePoint now) {
    auto pending = pending_.extract(made.frame);
    if (pending.empty()) return;
    FrameCost& last = costs_[{pending.mapped().view, pending.mapped().format}];
    last.cost = now - last.started;
    ship(pending.key(), std::move(pending.mapped()), made);
}

void Delivery::ship(std::uint64_t frame, PendingFrame&& pending, const Reconstructed& made) {
    wire::FrameHeader header = pending.header;
    const session::PictureSummary& summary = made.picture.summary;
    if (pending.format.picture != session::PictureEncoding::None && made.picture.bytes) {
        header.width = summary.width;
        header.height = summary.height;
        header.components = summary.components;
        header.picture_bytes = made.picture.bytes->size();
    }
    header.min_samples = made.min_samples;
    header.max_samples = made.max_samples;
    if (made.film_hash) header.film_hash = *made.film_hash;
    const auto no_picture = std::make_shared<const std::vector<std::byte>>();
    for (const Key& key : pending.receivers) {
        const auto watcher = watchers_.find(key);
        if (watcher == watchers_.end() || watcher->second.frame_in_flight != frame) continue;
        if (key.first == Keeper) {
            watcher->second.seen = pending.shown;
            ended_.push_back({pending.view, header, end_of(*views_.find(pending.view), made),
                              made.picture.bytes ? made.picture.bytes : no_picture});
            continue;
        }
        const SessionRecord* session = sessions_.find(key.first);
        const bool has_failed = !made.picture.error.empty() && !pending.is_end;
        const bool is_reachable = session != nullptr && (session->bulk || pending.is_end);
        if (has_failed || is_reachable) {  // a failed reconstruction is not retried until there is newer film
            watcher->second.seen = pending.shown;
            watcher->second.seen_version = header.version;
        }
        if (has_failed || !is_reachable) {
            watcher->second.frame_in_flight = 0;
            continue;
        }
        header.view = key.second;
        if (pending.is_end) {
            outbox_.control(
                session->control,
                encoded(wire::ViewDone{header.view, header.frame, end_of(*views_.find(pending.view), made)}));
        }
        shipments_.push_back(
            {.to = key,
             .view = pending.view,
             .frame = frame,
             .header = header,
             .picture = made.picture.bytes ? made.picture.bytes : no_picture,
             .tiles = pending.tiles,
             .tile_count = header.film_tiles,
             .tiles_requested = static_cast<std::uint32_t>(pending.tiles.size()),
             .film = pending.film,
             .form = pending.format.film_state ? FilmStore::TilesAs::Blocks : FilmStore::TilesAs::Merged});
    }
}

session::ViewSummary Delivery::end_of(const ViewState& view, const Reconstructed& made) const {
    session::ViewSummary summary = summary_of(view, views_.facts, outbox_.bytes);
    if (made.picture.bytes) {
        summary.picture = made.picture.summary;
        describe(view, summary.picture);
        summary.min_samples = made.min_samples;
        summary.max_samples = made.max_samples;
    }
    return summary;
}

void Delivery::send_kept(const SessionRecord& session, Ended kept) {
    kept.header.frame = next_frame_++;
    outbox_.control(session.control,
                    encoded(wire::ViewDone{kept.header.view, kept.header.frame, std::move(kept.summary)}));
    shipments_.push_back({.to = {session.id, kept.header.view},
                          .view = {},
                          .frame = kept.header.frame,
                          .header = kept.header,
                          .picture = std::move(kept.picture),
                          .tiles = {},
                          .film = {}});
}

std::size_t Delivery::in_flight(SessionId session) const {
    return static_cast<std::size_t>(
        std::count_if(shipments_.begin(), shipments_.end(),
                      [&](const Shipment& shipment) { return shipment.to.first == session; }));
}

void Delivery::send() {
    std::vector<SessionId> receivers;  // each once; the next after served_last_ first
    std::erase_if(shipments_, [&](const Shipment& shipment) {
        const SessionId id = shipment.to.first;
        if (sessions_.find(id) == nullptr) return true;  // disconnected
        if (std::ranges::find(receivers, id) == receivers.end()) receivers.push_back(id);
        return false;
    });
    if (const auto last = std::ranges::find(receivers, served_last_); last != receivers.end())
        std::rotate(receivers.begin(), std::next(last), receivers.end());
    has_more_ = false;
    std::size_t budget = BytesAtATime;
    for (const SessionId id : receivers) {
        const SessionRecord& session = *sessions_.find(id);
        bool goes_on = session.bulk.has_value();
        for (auto shipment = shipments_.begin(); goes_on && shipment != shipments_.end();) {
            const auto current = shipment++;
            if (current->to.first != id) continue;
            send(*current, session, budget);
            goes_on = current->is_done();
            if (goes_on) shipments_.erase(current);
        }
        if (!has_more_) continue;
        served_last_ = id;
        return;
    }
}

// Copies pictures, and tiles that others receive as well; has_more_ when `budget` was too small for that.
void Delivery::send(Shipment& shipment, const SessionRecord& session, std::size_t& budget) {
    const auto may_send = [&] {
        if (outbox_.waiting_bytes(net::Link::Bulk, *session.bulk) > BytesAhead) return false;
        has_more_ = budget == 0;
        return !has_more_;
    };
    if (shipment.header) outbox_.bulk(*session.bulk, *std::exchange(shipment.header, std::nullopt));
    while (shipment.picture_sent < shipment.picture->size()) {  // the picture goes before the film
        if (!may_send()) return;
        const auto piece = next_chunk(*shipment.picture, shipment.picture_sent);
        outbox_.bulk(*session.bulk, wire::PictureChunk{.frame = shipment.frame,
                                                       .total = shipment.picture->size(),
                                                       .offset = shipment.picture_sent,
                                                       .data = {piece.begin(), piece.end()}});
        shipment.picture_sent += piece.size();
        budget -= std::min(budget, piece.size());
    }
    for (; !shipment.tiles.empty(); shipment.tiles.pop_front()) {
        if (!may_send()) return;
        net::Bytes& tile = *shipment.tiles.front().bytes;
        budget -= std::min(budget, tile.size());
        if (shipment.tiles.front().ends_tile) ++shipment.tiles_sent;
        const bool is_last_receiver = shipment.tiles.front().bytes.use_count() == 1;
        outbox_.bulk(*session.bulk, is_last_receiver ? std::move(tile) : net::Bytes(tile),
                     &session::WireBytes::film);
    }
    const std::uint32_t until = std::min(shipment.tile_count, shipment.tiles_sent + TilesAhead);
    if (!shipment.film.value || until <= shipment.tiles_requested || !may_send()) return;
    film_.deliver(shipment.film, shipment.frame, shipment.tiles_requested, until, shipment.form);
    shipment.tiles_requested = until;
}

Delivery::FrameFormat format_of(const session::ViewRequest& request) {
    return {request.picture, request.film, request.film_state, request.frames, request.display_transform};
}

}  // namespace tessera::master
