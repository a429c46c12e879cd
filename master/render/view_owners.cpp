// Owners of views: those that were lost, those that come back, and those of a previous run.
#include "master/render/views.h"

namespace tessera::master {

namespace {

// A user who fetches the picture gets a file, not the pixels or the film that its lost client would have written one from.
Delivery::FrameFormat format_of_orphan(const session::ViewRequest& request) {
    Delivery::FrameFormat format = format_of(request);
    format.film = format.film_state = false;
    using enum session::PictureEncoding;
    if (format.picture == Planes || format.picture == None) format.picture = Exr;
    return format;
}

}  // namespace

// After a reconnection the owner may have another name than before.
std::string Views::name_of_unnamed(const ViewOwner& owner, std::uint64_t number) const {
    const std::string ending = "/" + std::to_string(number);
    for (const auto& [id, view] : table_.all()) {
        const bool is_owner = view.owner.user == owner.user && view.owner.key == owner.key;
        if (view.orphaned && is_owner && view.name.ends_with(ending)) return view.name;
    }
    return owner.name + ending;
}

void Views::session_left(SessionId session, DisconnectReason reason, TimePoint now) {
    picks_.session_left(session);
    for (const std::uint64_t number : delivery_.numbers(session)) {
        ViewState& view = *table_.find(*delivery_.watched(session, number));
        const bool is_owner = view.owner.session == session;
        const bool has_its_end = view.has_ended() && delivery_.has_taken_end(session, number);
        if (reason == DisconnectReason::Graceful || has_its_end || (!view.shows_all() && !is_owner)) {
            end(session, {.number = number}, now);
            continue;
        }
        delivery_.leave(session, number);
        if (view.request.detached) continue;
        if (delivery_.watchers(view.id) == 0 || is_owner) view.orphaned = now;
        if (!view.shows_all() && settings_.orphan_limit > Duration::zero())
            delivery_.keep(view.id, format_of_orphan(view.request));
    }
}

std::optional<Duration> Views::orphan_time(const ViewState& view, TimePoint now) const {
    if (!view.orphaned || view.request.detached) return std::nullopt;
    return *view.orphaned + settings_.orphan_limit - now;
}

void Views::restore(std::vector<wire::SavedView>&& saved, Version version, Hash128 scene_hash,
                    TimePoint now) {
    for (wire::SavedView& old : saved) {
        if (table_.all().size() >= settings_.max_views) return;
        ViewState& view = table_.add();
        view.name = old.name;
        view.owner = {.session = {}, .name = {}, .user = old.owner_user, .key = old.owner_key};
        view.request = std::move(old.request);
        view.request.view.id = {};
        view.request.view.revision = 1;
        view.asked = view.request.view;
        view.asked_revision = 1;
        view.version = version;
        view.scene_hash = scene_hash;
        view.waits_since = now;
        view.orphaned = now;
        const session::ViewRequest& request = view.request;
        if (request.detached) {
            delivery_.keep(view.id, format_of(request));
        } else if (!view.shows_all()) {
            delivery_.keep(view.id, format_of_orphan(request));
        }
        // Film of another scene is useless, and a view with a time limit must start over.
        if (old.blocks.empty() || old.scene_hash_of_film != scene_hash || view.request.stop.has_clock())
            continue;
        if (request.reproducible && old.kind.empty()) continue;  // by which nodes is unknown
        view.films = old.films;
        runner_.resume(view, {std::move(old.blocks), old.steps, std::move(old.step)}, old.kind, now);
    }
}

void Views::forget_orphans(TimePoint now) {
    std::vector<ViewId> forgotten;
    for (const auto& [id, view] : table_.all()) {
        if (!view.orphaned || view.request.detached) continue;
        const bool is_watched = delivery_.watchers(id) > (delivery_.is_kept(id) ? 1u : 0u);
        const Duration limit = view.shows_all() ? settings_.orphan_patience : settings_.orphan_limit;
        if (!is_watched && now - *view.orphaned > limit) forgotten.push_back(id);
    }
    for (const ViewId view : forgotten) remove(view);
}

}  // namespace tessera::master
