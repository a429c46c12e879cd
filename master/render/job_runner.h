#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "master/peers/event.h"
#include "master/peers/node_table.h"
#include "master/peers/outbox.h"
#include "master/peers/session_table.h"
#include "master/render/film_merger.h"
#include "master/render/job.h"
#include "master/render/time_budget.h"

namespace tessera::master {

struct JobSettings {
    Duration progress_interval = std::chrono::milliseconds(100);
    Duration overdue_patience = std::chrono::seconds(5);  // film neither in hand nor here: lost
    Duration stop_grace = std::chrono::seconds(2);        // for the film of stopped units
    std::uint32_t failure_limit = 8;
};

// Runs one job at a time: waits for nodes, deals units, takes film, decides when the frame is done, delivers
// it. Told of events by the render master; owns no socket.
class JobRunner {
  public:
    JobRunner(const JobSettings& settings, NodeTable& nodes, SessionTable& sessions, Outbox& outbox,
              EventSink events, std::function<void()> wake);

    bool busy() const { return job_.has_value(); }
    // The bytes a job is charged with start here: its scene travels before it does.
    void scene_opened() { bytes_before_ = outbox_.bytes; }
    std::optional<SessionId> session() const;
    void start(SessionId session, wire::StartJob request, Version version, TimePoint now);
    void stop(JobId job, TimePoint now);  // deliver what there is
    // Another filter for the frame that is being rendered; the answer says what that means, or why not.
    wire::FilterSet set_filter(const std::string& filter, TimePoint now);
    void abandon();  // the client is gone: no delivery

    void film(net::PeerId bulk_peer, net::Bytes message);
    void released(NodeRecord& node, const wire::UnitReleased& release, TimePoint now);
    void goodbye(NodeRecord& node, const wire::Goodbye& goodbye);
    void node_gone(NodeId node);
    void scene_facts(const wire::VersionReport& report);

    void tick(TimePoint now);
    TimePoint next_event(TimePoint now) const;
    const wire::UnitCounts& total_counts() const { return total_; }
    std::uint64_t malformed_film() const { return malformed_film_; }
    const Balancer& balancer() const { return balancer_; }

  private:
    bool suits(const NodeRecord& node) const;  // could take part, at whatever version
    bool ready(const NodeRecord& node) const;  // suits, and holds the version
    void wait_for_nodes(TimePoint now);
    bool budget_is_planned(TimePoint now);
    void choose_scale(TimePoint now);
    void begin_picture(TimePoint now);
    const view::View& view() const { return job_->stage ? *job_->stage : job_->request.view; }
    bool time_is_up(TimePoint now) const;
    void begin_rendering(TimePoint now);
    void render(TimePoint now);
    void deal(TimePoint now);
    void collect_overdue(TimePoint now);
    void take_merger_output(TimePoint now);
    void take(const MergeReport& report, TimePoint now);
    void account(const MergeReport& report, NodeRecord& node);
    void cancel(const std::vector<Cancellation>& cancellations);
    void close_view(ViewId closed);
    void decide(wire::JobOutcome outcome, std::string message, TimePoint now);
    void begin_filtering(TimePoint now);
    void take(Reconstructed&& made, TimePoint now);
    void begin_delivery(TimePoint now);
    void deliver();
    std::uint32_t tiles_to_deliver() const;
    void send_progress(TimePoint now);
    wire::JobDone summary() const;

    JobSettings settings_;
    NodeTable& nodes_;
    SessionTable& sessions_;
    Outbox& outbox_;
    EventSink events_;
    FilmMerger merger_;
    Balancer balancer_;
    TimeBudget time_budget_;
    std::optional<Job> job_;
    std::uint64_t next_view_ = 1, next_unit_ = 1;
    std::uint64_t triangles_ = 0, instances_ = 0, lights_ = 0;  // as the nodes last reported
    wire::WireBytes bytes_before_;
    wire::UnitCounts total_;
    std::uint64_t malformed_film_ = 0;
};

}  // namespace tessera::master
