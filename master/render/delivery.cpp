#include "master/render/delivery.h"

#include <algorithm>
#include <set>

#include "master/render/picture_chunks.h"
#include "master/render/view_summary.h"

namespace tessera::master {

namespace {
constexpr std::uint32_t TilesAhead = 32;                   // encoded by the film store and not yet sent
constexpr std::size_t BytesAhead = std::size_t{32} << 20;  // waiting for a slow client
}  // namespace

void Delivery::watch(SessionId session, std::uint64_t number, ViewId view, const Wish& wish) {
    Watcher& watcher = watchers_[{session, number}];
    if (watcher.view != view || watcher.wish != wish) watcher.seen.reset();
    watcher.view = view;
    watcher.wish = wish;
}

void Delivery::leave(SessionId session, std::uint64_t number) {
    const Key key{session, number};
    watchers_.erase(key);
    std::erase_if(shipments_, [&](const Shipment& shipment) { return shipment.to == key; });
}

void Delivery::taken(SessionId session, const wire::FrameTaken& taken) {
    const auto watcher = watchers_.find({session, taken.number});
    if (watcher != watchers_.end() && watcher->second.on_its_way == taken.frame)
        watcher->second.on_its_way = 0;
}

void Delivery::resumed(SessionId session) {
    for (auto& [key, watcher] : watchers_) {
        if (key.first != session) continue;
        watcher.on_its_way = 0;
        watcher.seen.reset();
    }
    std::erase_if(shipments_, [&](const Shipment& shipment) { return shipment.to.first == session; });
}

void Delivery::forget(ViewId view) {
    std::erase_if(watchers_, [&](const auto& entry) { return entry.second.view == view; });
    std::erase_if(making_, [&](const auto& entry) { return entry.second.view == view; });
    std::erase_if(made_, [&](const auto& entry) { return entry.first.first == view; });
    std::erase_if(shipments_, [&](const Shipment& shipment) { return shipment.view == view; });
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

std::vector<std::uint64_t> Delivery::numbers(SessionId session) const {
    std::vector<std::uint64_t> numbers;
    for (const auto& [key, watcher] : watchers_) {
        if (key.first == session) numbers.push_back(key.second);
    }
    return numbers;
}

void Delivery::offer(const ViewState& view, TimePoint now, Duration interval) {
    if (!view.shown || view.shown->revision != view.revision) return;
    const Shown& shown = *view.shown;
    std::map<Wish, std::vector<Key>> free;
    for (const auto& [key, watcher] : watchers_) {
        const bool has_seen = watcher.seen == shown && watcher.seen_version == view.version;
        if (watcher.view != view.id || watcher.on_its_way != 0 || has_seen) continue;
        const bool waits = watcher.wish.frames == session::Frames::Last || view.passes.empty();
        if (waits && !shown.complete) continue;
        free[watcher.wish].push_back(key);
    }
    for (auto& [wish, receivers] : free) {
        const bool busy = std::any_of(making_.begin(), making_.end(), [&](const auto& entry) {
            return entry.second.view == view.id && entry.second.wish == wish;
        });
        Made& last = made_[{view.id, wish}];
        const bool news = last.shown != shown &&
                          (shown.complete || shown.pass + 1 < view.passes.size() || shown.samples == 0);
        constexpr int CostLimit = 4;
        if (busy || (!news && now - last.started < std::max(interval, CostLimit * last.cost))) continue;
        last.started = now;
        last.shown = shown;
        begin(view, wish, std::move(receivers));
    }
}

Delivery::Making Delivery::frame_of(const ViewState& view, const Wish& wish, std::uint64_t frame) const {
    Making making{
        .view = view.id, .wish = wish, .shown = *view.shown, .header = {}, .tiles = {}, .receivers = {}};
    making.header = {.frame = frame,
                     .version = view.version,
                     .revision = view.camera_revision,
                     .encoding = wish.picture,
                     .spp = view.request.stop.spp,
                     .complete = view.shown->complete};
    making.is_end = view.shown->complete && view.run.outcome.has_value();
    if (view.passes.empty()) return making;
    const Pass& pass = view.passes[view.shown->pass];
    making.header.scale = pass.scale;
    making.header.width = static_cast<std::uint32_t>(pass.view.window.width);
    making.header.height = static_cast<std::uint32_t>(pass.view.window.height);
    return making;
}

void Delivery::begin(const ViewState& view, const Wish& wish, std::vector<Key> receivers) {
    const std::uint64_t frame = next_frame_++;
    Making making = frame_of(view, wish, frame);
    for (const Key& key : receivers) watchers_.at(key).on_its_way = frame;
    making.receivers = std::move(receivers);
    const bool waited = wish.frames == session::Frames::Last;
    if (view.passes.empty()) return ship(frame, std::move(making), {});
    const Pass& pass = view.passes[view.shown->pass];
    if (wish.film) {
        making.header.film_tiles = pass.tiles;
        making.header.film_window = pass.view.window;
        if (waited) {
            making.film = pass.view.id;  // nothing is added to it any more
        } else {
            film_.deliver(pass.view.id, frame, 0, making.header.film_tiles);
        }
    }
    const bool nothing_to_make = waited ? !has_picture(view, wish.picture) : view.run.samples == 0;
    if (making.is_end && nothing_to_make) return ship(frame, std::move(making), {});
    const bool hash = making.shown.complete && !waited;
    film_.reconstruct(frame, pass.view, view.version, {wish.picture, wish.transform, view.id},
                      hash ? FilmStore::FilmHash::Wanted : FilmStore::FilmHash::NotWanted);
    making_.emplace(frame, std::move(making));
}

void Delivery::report_progress(const ViewState& view, std::uint32_t nodes) {
    for (const auto& [key, watcher] : watchers_) {
        if (watcher.view != view.id || watcher.wish.frames != session::Frames::Last) continue;
        if (const SessionRecord* session = sessions_.find(key.first))
            outbox_.control(session->control, wire::ViewProgress{key.second, progress_of(view, nodes)});
    }
}

void Delivery::take(EncodedTile&& tile) {
    if (const auto making = making_.find(tile.frame); making != making_.end()) {
        making->second.tiles.push_back(std::move(tile.bytes));
        return;
    }
    for (Shipment& shipment : shipments_) {
        if (shipment.frame == tile.frame) return shipment.tiles.push_back(std::move(tile.bytes));
    }
}

std::optional<ViewId> Delivery::ends(std::uint64_t frame) const {
    const auto making = making_.find(frame);
    if (making == making_.end() || !making->second.shown.complete) return std::nullopt;
    return making->second.view;
}

void Delivery::take(const Reconstructed& made, TimePoint now) {
    auto making = making_.extract(made.frame);
    if (making.empty()) return;
    Made& last = made_[{making.mapped().view, making.mapped().wish}];
    last.cost = now - last.started;
    ship(making.key(), std::move(making.mapped()), made);
}

void Delivery::ship(std::uint64_t frame, Making&& making, const Reconstructed& made) {
    wire::FrameHeader header = making.header;
    const session::PictureSummary& summary = made.picture.summary;
    if (making.wish.picture != session::PictureEncoding::None && made.picture.bytes) {
        header.width = summary.width;
        header.height = summary.height;
        header.components = summary.components;
        header.picture_bytes = made.picture.bytes->size();
    }
    header.samples_least = made.samples_least;
    header.samples_most = made.samples_most;
    if (made.film_hash) header.film_hash = *made.film_hash;
    const auto no_picture = std::make_shared<const std::vector<std::byte>>();
    for (const Key& key : making.receivers) {
        const auto watcher = watchers_.find(key);
        if (watcher == watchers_.end() || watcher->second.on_its_way != frame) continue;
        if (key.first == Keeper) {
            watcher->second.seen = making.shown;
            ended_.push_back({making.view, header, end_of(*views_.find(making.view), made),
                              made.picture.bytes ? made.picture.bytes : no_picture});
            continue;
        }
        const SessionRecord* session = sessions_.find(key.first);
        const bool has_failed = !made.picture.error.empty() && !making.is_end;
        const bool is_reachable = session != nullptr && (session->bulk || making.is_end);
        if (has_failed || is_reachable) {  // what cannot be made is not tried again until there is newer
            watcher->second.seen = making.shown;
            watcher->second.seen_version = header.version;
        }
        if (has_failed || !is_reachable) {
            watcher->second.on_its_way = 0;
            continue;
        }
        header.view = key.second;
        if (making.is_end) {
            outbox_.control(
                session->control,
                encoded(wire::ViewDone{header.view, header.frame, end_of(*views_.find(making.view), made)}));
        }
        shipments_.push_back({.to = key,
                              .view = making.view,
                              .frame = frame,
                              .header = header,
                              .picture = made.picture.bytes ? made.picture.bytes : no_picture,
                              .tiles = making.tiles,
                              .tile_count = header.film_tiles,
                              .tiles_requested = static_cast<std::uint32_t>(making.tiles.size()),
                              .film = making.film});
    }
}

session::ViewSummary Delivery::end_of(const ViewState& view, const Reconstructed& made) const {
    session::ViewSummary summary = summary_of(view, views_.facts, outbox_.bytes);
    if (made.picture.bytes) {
        summary.picture = made.picture.summary;
        describe(view, summary.picture);
        summary.samples_least = made.samples_least;
        summary.samples_most = made.samples_most;
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

std::size_t Delivery::on_their_way(SessionId session) const {
    return static_cast<std::size_t>(
        std::count_if(shipments_.begin(), shipments_.end(),
                      [&](const Shipment& shipment) { return shipment.to.first == session; }));
}

void Delivery::send() {
    std::set<SessionId> busy;
    std::erase_if(shipments_, [&](Shipment& shipment) {
        const SessionRecord* session = sessions_.find(shipment.to.first);
        if (session == nullptr) return true;  // it has gone
        if (busy.contains(shipment.to.first) || !session->bulk) return false;
        send(shipment, *session);
        if (!shipment.is_done()) busy.insert(shipment.to.first);
        return shipment.is_done();
    });
}

void Delivery::send(Shipment& shipment, const SessionRecord& session) {
    const auto has_room = [&] { return outbox_.waiting_bytes(net::Link::Bulk, *session.bulk) <= BytesAhead; };
    if (shipment.header) outbox_.bulk(*session.bulk, *std::exchange(shipment.header, std::nullopt));
    while (shipment.picture_sent < shipment.picture->size()) {  // what somebody is waiting for goes first
        if (!has_room()) return;
        const auto piece = next_chunk(*shipment.picture, shipment.picture_sent);
        outbox_.bulk(*session.bulk, wire::PictureChunk{.frame = shipment.frame,
                                                       .total = shipment.picture->size(),
                                                       .offset = shipment.picture_sent,
                                                       .data = {piece.begin(), piece.end()}});
        shipment.picture_sent += piece.size();
    }
    for (; !shipment.tiles.empty() && has_room(); shipment.tiles.pop_front(), ++shipment.tiles_sent)
        outbox_.bulk(*session.bulk, std::move(shipment.tiles.front()), &session::WireBytes::film);
    const std::uint32_t until = std::min(shipment.tile_count, shipment.tiles_sent + TilesAhead);
    if (!shipment.film.value || until <= shipment.tiles_requested || !has_room()) return;
    film_.deliver(shipment.film, shipment.frame, shipment.tiles_requested, until);
    shipment.tiles_requested = until;
}

}  // namespace tessera::master
