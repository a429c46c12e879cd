#include "master/scene/edit_trace.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

namespace tessera::master {

namespace {

std::int64_t ns(TimePoint time) {
    return time.time_since_epoch().count();
}

// A peer's time in the master's clock; 0 = unknown.
std::int64_t ours(std::int64_t theirs, const std::optional<net::ClockOffset>& clock) {
    return theirs == 0 || !clock ? 0 : net::to_our_clock(theirs, *clock);
}

class Stage {
  public:
    explicit Stage(std::string name) : name_(std::move(name)) {}
    // Peers' clocks are known only within a bound, so an end may seem to precede its beginning. Doubles cannot
    // overflow whatever times a peer sends.
    void add(std::int64_t from, std::int64_t to) {
        if (from == 0 || to == 0) return;
        seconds_.push_back(std::max(0.0, (static_cast<double>(to) - static_cast<double>(from)) * 1e-9));
    }
    session::StageTimes summary() {
        std::sort(seconds_.begin(), seconds_.end());
        return {name_, seconds_.size(), rank(0.50), rank(0.99)};
    }

  private:
    double rank(double part) const {
        if (seconds_.empty()) return 0.0;
        const auto it = static_cast<std::size_t>(std::ceil(part * static_cast<double>(seconds_.size())));
        return seconds_[std::max<std::size_t>(it, 1) - 1];
    }
    std::string name_;
    std::vector<double> seconds_;
};

}  // namespace

void EditTraceLog::submitted(const Submitted& edit) {
    edits_.push_back({.transaction = edit.transaction,
                      .name = edit.name,
                      .edit_bytes = edit.bytes,
                      .submitted = ours(edit.submitted_at, edit.clock),
                      .bound = edit.clock ? edit.clock->bound.count() : 0,
                      .received = ns(edit.received),
                      .version = edit.version});
    ++count_;
    bytes_ += edit.bytes;
    if (edits_.size() > MaxEdits) edits_.pop_front();
}

void EditTraceLog::for_each_up_to(Version version, std::uint64_t& next,
                                  const std::function<void(session::EditTrace&)>& visit) {
    for (next = std::max(next, begin()); next < end(); ++next) {
        session::EditTrace& edit = edits_[next - begin()];
        if (edit.version.epoch == version.epoch && edit.version.number > version.number) return;
        if (edit.version.epoch == version.epoch) visit(edit);
    }
}

void EditTraceLog::published(Version version, TimePoint now) {
    for_each_up_to(version, next_published_, [&](session::EditTrace& edit) { edit.published = ns(now); });
}

void EditTraceLog::node_built(NodeId node, const std::string& name, Version version, std::int64_t received_at,
                              std::int64_t built_at, const std::optional<net::ClockOffset>& clock) {
    const auto [it, is_new] = nodes_.try_emplace(node, begin());
    for_each_up_to(version, it->second, [&](session::EditTrace& edit) {
        if (is_new) return;
        edit.nodes.push_back({.name = name,
                              .received = ours(received_at, clock),
                              .built = ours(built_at, clock),
                              .bound = clock ? clock->bound.count() : 0});
    });
}

void EditTraceLog::merged(Version version, TimePoint now) {
    for_each_up_to(version, next_merged_, [&](session::EditTrace& edit) { edit.merged = ns(now); });
}

std::vector<session::EditTrace> EditTraceLog::latest(std::size_t count) const {
    const auto kept = static_cast<std::ptrdiff_t>(std::min(count, edits_.size()));
    return {edits_.end() - kept, edits_.end()};
}

std::vector<session::StageTimes> EditTraceLog::stages() const {
    Stage to_master("client to master"), to_published("master to published"), to_node("published to node"),
        to_built("node to built"), to_picture("built to picture"), whole("whole");
    for (const session::EditTrace& edit : edits_) {
        to_master.add(edit.submitted, edit.received);
        to_published.add(edit.received, edit.published);
        std::int64_t first_built = 0;
        for (const session::NodeTrace& node : edit.nodes) {
            to_node.add(edit.published, node.received);
            to_built.add(node.received, node.built);
            if (node.built != 0 && (first_built == 0 || node.built < first_built)) first_built = node.built;
        }
        to_picture.add(first_built, edit.merged);
        whole.add(edit.submitted, edit.merged);
    }
    return {to_master.summary(), to_published.summary(), to_node.summary(),
            to_built.summary(),  to_picture.summary(),   whole.summary()};
}

}  // namespace tessera::master
