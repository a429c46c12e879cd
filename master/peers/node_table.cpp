#include "master/peers/node_table.h"

#include <algorithm>

namespace tessera::master {

namespace {

bool has_null_backend(const wire::Hello& hello) {
    return hello.backend == "null" || hello.kind.substr(0, hello.kind.find_first_of("-/")) == "null";
}

}  // namespace

NodeCapacity NodeRecord::capacity() const {
    constexpr std::uint32_t SlotsPerWorker =
        2;  // one unit that it renders, and one prefetched: node/work_queue.h
    const auto on_the_way = static_cast<std::uint32_t>(pending.size());
    const std::uint32_t workers = std::max(1u, hello.concurrent_units);
    const std::uint32_t slots = std::min(state.free_slots, SlotsPerWorker * workers);
    return {.node = id,
            .workers = workers,
            .free_slots = slots > on_the_way ? slots - on_the_way : 0,
            .in_flight = static_cast<std::uint32_t>(state.in_flight.size()) + on_the_way,
            .round_trip_seconds = round_trip_seconds,
            .heartbeat_at = heartbeat_at};
}

std::optional<wire::OpenView> NodeRecord::opening(const view::View& view, Duration hold_film) {
    std::uint64_t& revision = views[view.id];
    if (revision == view.revision) return std::nullopt;
    revision = view.revision;
    view::View opened = view;
    opened.filter.clear();  // only the master uses it
    return wire::OpenView{std::move(opened), hold_film};
}

NodeRecord& NodeTable::add(NodeId id, std::uint64_t token, net::PeerId control, std::string user,
                           wire::Hello hello, TimePoint now) {
    NodeRecord record{.id = id,
                      .token = token,
                      .control = control,
                      .bulk = {},
                      .user = std::move(user),
                      .hello = std::move(hello),
                      .liveness = net::Liveness(liveness_, now)};
    record.is_null = has_null_backend(record.hello);
    record.last_progress_at = now;
    remove(id);
    renderers_ += record.is_null ? 0 : 1;
    return nodes_.emplace(id, std::move(record)).first->second;
}

void NodeTable::remove(NodeId id) {
    constexpr std::size_t MaxRemoved = 1024;
    const auto node = nodes_.extract(id);
    if (!node) return;
    if (!node.mapped().is_null) --renderers_;
    removed_.emplace(id, node.mapped().token);
    if (removed_.size() > MaxRemoved) removed_.erase(removed_.begin());
}

std::optional<NodeId> NodeTable::removed(std::uint64_t token) const {
    const auto found = std::ranges::find(removed_, token, &std::pair<const NodeId, std::uint64_t>::second);
    return found == removed_.end() ? std::nullopt : std::optional(found->first);
}

NodeRecord* NodeTable::find(NodeId id) {
    const auto it = nodes_.find(id);
    return it == nodes_.end() ? nullptr : &it->second;
}

NodeRecord* NodeTable::by_control(net::PeerId peer) {
    const auto it =
        std::find_if(nodes_.begin(), nodes_.end(), [&](auto& entry) { return entry.second.control == peer; });
    return it == nodes_.end() ? nullptr : &it->second;
}

NodeRecord* NodeTable::by_bulk(net::PeerId peer) {
    const auto it =
        std::find_if(nodes_.begin(), nodes_.end(), [&](auto& entry) { return entry.second.bulk == peer; });
    return it == nodes_.end() ? nullptr : &it->second;
}

NodeRecord* NodeTable::by_token(std::uint64_t token) {
    const auto it =
        std::find_if(nodes_.begin(), nodes_.end(), [&](auto& entry) { return entry.second.token == token; });
    return it == nodes_.end() ? nullptr : &it->second;
}

void NodeTable::heartbeat(NodeRecord& node, const wire::Heartbeat& heartbeat, TimePoint now) {
    const bool same_phase = node.state.phase == heartbeat.phase;
    node.state = heartbeat;
    node.heartbeat_at = now;
    node.leaving = node.leaving || heartbeat.phase == session::NodePhase::Leaving;
    std::erase_if(node.pending,
                  [&](const auto& work) { return work.second <= heartbeat.last_work_sequence; });
    const auto round_trip =
        node.clock.heartbeat(heartbeat.sent_at, heartbeat.echo_sent_at, heartbeat.echo_delay, now);
    if (round_trip) node.round_trip_seconds = seconds(*round_trip);
    const bool builds = heartbeat.phase == session::NodePhase::Building;
    const bool works = builds || heartbeat.phase == session::NodePhase::Rendering;
    if (!works || !same_phase || heartbeat.progress > node.last_progress) {
        node.last_progress = heartbeat.progress;
        node.last_progress_at = now;
    }
    node.stuck = works && now - node.last_progress_at >
                              (builds ? stuck_.building : std::max(stuck_.allowance, node.allowance));
    node.stuck_is_announced = node.stuck_is_announced && node.stuck;
}

std::vector<NodeId> NodeTable::timed_out(TimePoint now) const {
    std::vector<NodeId> timed_out;
    for (const auto& [id, node] : nodes_) {
        if (node.liveness.timed_out(now)) timed_out.push_back(id);
    }
    return timed_out;
}

std::vector<UnitId> NodeTable::overdue(NodeRecord& node, const std::vector<UnitId>& held, TimePoint now,
                                       Duration timeout) {
    std::map<UnitId, TimePoint> unreported_since;
    std::vector<UnitId> overdue;
    for (const UnitId unit : held) {
        const auto& in_flight = node.state.in_flight;
        if (node.pending.contains(unit) ||
            std::find(in_flight.begin(), in_flight.end(), unit) != in_flight.end())
            continue;
        const auto known = node.unreported_since.find(unit);
        const TimePoint since = known == node.unreported_since.end() ? now : known->second;
        unreported_since.emplace(unit, since);
        if (now - since > timeout) overdue.push_back(unit);
    }
    node.unreported_since = std::move(unreported_since);
    return overdue;
}

}  // namespace tessera::master
