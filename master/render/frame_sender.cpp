#include "master/render/frame_sender.h"

#include <algorithm>
#include <span>

namespace tessera::master {

namespace {
constexpr std::size_t FrameChunkBytes = std::size_t{1} << 20;
}

void FrameSender::watch(SessionId session, std::uint64_t number, ViewId view, const Wish& wish) {
    Watcher& watcher = watchers_[{session, number}];
    if (watcher.view != view || watcher.wish != wish) watcher.seen.reset();
    watcher.view = view;
    watcher.wish = wish;
}

void FrameSender::leave(SessionId session, std::uint64_t number) {
    watchers_.erase({session, number});
}

void FrameSender::leave_all(SessionId session) {
    std::erase_if(watchers_, [&](const auto& entry) { return entry.first.first == session; });
}

void FrameSender::taken(SessionId session, const wire::FrameTaken& taken) {
    const auto watcher = watchers_.find({session, taken.number});
    if (watcher != watchers_.end() && watcher->second.on_its_way == taken.frame)
        watcher->second.on_its_way = 0;
}

void FrameSender::resumed(SessionId session) {
    for (auto& [key, watcher] : watchers_) {
        if (key.first != session) continue;
        watcher.on_its_way = 0;
        watcher.seen.reset();
    }
}

void FrameSender::forget(ViewId view) {
    std::erase_if(watchers_, [&](const auto& entry) { return entry.second.view == view; });
    std::erase_if(making_, [&](const auto& entry) { return entry.second.view == view; });
    std::erase_if(made_, [&](const auto& entry) { return entry.first.first == view; });
}

std::optional<ViewId> FrameSender::watched(SessionId session, std::uint64_t number) const {
    const auto watcher = watchers_.find({session, number});
    if (watcher == watchers_.end()) return std::nullopt;
    return watcher->second.view;
}

std::uint64_t FrameSender::watchers(ViewId view) const {
    return static_cast<std::uint64_t>(std::count_if(
        watchers_.begin(), watchers_.end(), [&](const auto& entry) { return entry.second.view == view; }));
}

std::vector<std::uint64_t> FrameSender::numbers(SessionId session) const {
    std::vector<std::uint64_t> numbers;
    for (const auto& [key, watcher] : watchers_) {
        if (key.first == session) numbers.push_back(key.second);
    }
    return numbers;
}

void FrameSender::offer(LiveView& live, TimePoint now, Duration interval) {
    if (!live.shown || live.shown->revision != live.revision) return;
    const Shown& shown = *live.shown;
    std::map<Wish, std::vector<Key>> free;
    for (auto& [key, watcher] : watchers_) {
        if (watcher.view != live.id || watcher.on_its_way != 0 ||
            (watcher.seen == shown && watcher.seen_version == live.version)) {
            continue;
        }
        free[watcher.wish].push_back(key);
    }
    for (auto& [wish, receivers] : free) {
        const bool busy = std::any_of(making_.begin(), making_.end(), [&](const auto& entry) {
            return entry.second.view == live.id && entry.second.wish == wish;
        });
        Made& last = made_[{live.id, wish}];
        const bool news = last.shown != shown &&
                          (shown.complete || shown.pass + 1 < live.passes.size() || shown.samples == 0);
        constexpr int CostLimit = 4;
        if (busy || (!news && now - last.started < std::max(interval, CostLimit * last.cost))) continue;
        last.started = now;
        last.shown = shown;
        const std::uint64_t frame = next_frame_++;
        const LivePass& pass = live.passes[shown.pass];
        const JobId job{frame};
        Making making{
            .view = live.id, .wish = wish, .shown = shown, .header = {}, .tiles = {}, .receivers = {}};
        making.header = {.frame = frame,
                         .version = live.version,
                         .revision = live.camera_revision,
                         .scale = pass.scale,
                         .encoding = wish.picture,
                         .spp = live.spp,
                         .complete = shown.complete};
        making.header.width = static_cast<std::uint32_t>(pass.view.window.width);
        making.header.height = static_cast<std::uint32_t>(pass.view.window.height);
        if (wish.film) {
            making.header.film_tiles = static_cast<std::uint32_t>(pass.scheduler->tiles().size());
            merger_.deliver(pass.view.id, job, 0, making.header.film_tiles);
        }
        merger_.reconstruct(job, pass.view, wish.picture,
                            shown.complete ? FilmMerger::FilmHash::Wanted : FilmMerger::FilmHash::NotWanted);
        for (const Key& key : receivers) watchers_[key].on_its_way = frame;
        making.receivers = std::move(receivers);
        making_.emplace(frame, std::move(making));
    }
}

bool FrameSender::take(EncodedTile&& tile) {
    const auto making = making_.find(tile.job.value);
    if (making == making_.end()) return false;
    making->second.tiles.push_back(std::move(tile.bytes));
    return true;
}

bool FrameSender::take(Reconstructed&& made, TimePoint now) {
    auto making = making_.extract(made.job.value);
    if (making.empty()) return false;
    Made& last = made_[{making.mapped().view, making.mapped().wish}];
    last.cost = now - last.started;
    send(making.key(), std::move(making.mapped()), made);
    return true;
}

void FrameSender::send(std::uint64_t frame, Making&& making, const Reconstructed& made) {
    wire::LiveFrame header = making.header;
    const wire::PictureSummary& summary = made.picture.summary;
    if (making.wish.picture != wire::PictureEncoding::None) {
        header.width = summary.width;
        header.height = summary.height;
        header.components = summary.components;
        header.picture_bytes = made.picture.bytes->size();
    }
    header.samples_least = made.samples_least;
    header.samples_most = made.samples_most;
    if (made.film_hash) header.film_hash = *made.film_hash;
    for (const Key& key : making.receivers) {
        const auto watcher = watchers_.find(key);
        if (watcher == watchers_.end() || watcher->second.on_its_way != frame) continue;
        const SessionRecord* session = sessions_.find(key.first);
        const bool has_failed = !made.picture.error.empty();
        const bool is_reachable = session != nullptr && session->bulk;
        if (has_failed || is_reachable) {  // what cannot be made is not tried again until there is newer
            watcher->second.seen = making.shown;
            watcher->second.seen_version = header.version;
        }
        if (has_failed || !is_reachable) {
            watcher->second.on_its_way = 0;
            continue;
        }
        header.view = key.second;
        outbox_.bulk(*session->bulk, header);
        const std::span<const std::byte> picture(*made.picture.bytes);
        for (std::size_t offset = 0; offset < picture.size(); offset += FrameChunkBytes) {
            const auto piece = picture.subspan(offset, std::min(FrameChunkBytes, picture.size() - offset));
            outbox_.bulk(*session->bulk, wire::PictureChunk{.job = JobId{frame},
                                                            .total = picture.size(),
                                                            .offset = offset,
                                                            .data = {piece.begin(), piece.end()}});
        }
        for (const net::Bytes& tile : making.tiles)
            outbox_.bulk(*session->bulk, net::Bytes(tile), &wire::WireBytes::film);
    }
}

}  // namespace tessera::master
