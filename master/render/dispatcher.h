#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "master/peers/event.h"
#include "master/peers/node_table.h"
#include "master/peers/outbox.h"
#include "master/render/percentiles.h"
#include "master/render/render_outputs.h"
#include "master/render/schedule/scheduler.h"
#include "master/render/verifier.h"
#include "mediator/wire/envelope.h"

namespace tessera::master {

// Which nodes may render a pass.
struct NodeRequirements {
    Version version;            // of the scene that they must hold
    bool reproducible = false;  // only nodes of one kind, pinned to AVX2
    std::string kind{};         // that one; "" = the kind that renders most, see leading_kind()
};

// Assigns the units of passes to nodes: deals units, takes back released, lost and orphaned ones, cancels those that
// are no longer needed, measures the speed of nodes. Passes are identified by the ids of their views. Driven by the
// master's event loop; owns no socket.
class Dispatcher {
  public:
    // `overdue_patience`: a unit that the node does not hold and whose film has not arrived for this long is lost.
    Dispatcher(Duration overdue_patience, const Clock& clock, NodeTable& nodes, Outbox& outbox,
               EventSink events, const VerifierSettings& verifier = {});

    // ---- passes ----
    // Deals units of the pass from now on. An earlier pass with its id ends; nodes replace their view.
    Scheduler& begin(const view::View& view, const PlanSettings& plan, const NodeRequirements& requirements,
                     std::optional<TimePoint> deadline = {});
    void end(ViewId pass);     // cancelled; nodes forget its view
    void cancel(ViewId pass);  // deals no more units; film in flight is still merged
    void seal(ViewId pass);    // its film gets no more samples
    // The view continues under another revision: units in flight are dealt again.
    void revise(const view::View& view);
    void follow(ViewId pass, Version version);  // another version of the scene with the same samples
    Scheduler* find(ViewId pass);
    const Scheduler* find(ViewId pass) const;

    // ---- nodes ----
    std::vector<NodeCapacity> capacities() const;
    // To suitable nodes that are ready; reduces `capacities`.
    void deal(ViewId pass, std::vector<NodeCapacity>& capacities, TimePoint now);
    // Film to be verified, to other nodes than those that sent it.
    void deal_verifications(std::vector<NodeCapacity>& capacities, TimePoint now);
    // How many nodes could render the view, and how many are ready to.
    struct Prospects {
        std::uint32_t suitable = 0, ready = 0;
        std::uint32_t workers = 0;        // of suitable nodes
        double samples_per_second = 0.0;  // of ready nodes; 0 = not measured
        double slowest_worker = 0.0;      // samples per second, of suitable nodes that were measured
        std::uint32_t building = 0;       // suitable nodes that build the scene
        std::uint64_t scene_bytes = 0;    // that suitable nodes have received; grows while they sync
    };
    Prospects prospects(const view::View& view, const NodeRequirements& requirements) const;
    // The kind whose suitable nodes, pinned to AVX2, render most together; "" = there is none.
    std::string leading_kind(const view::View& view, Version version) const;
    std::string kind(ViewId pass) const;  // of a reproducible pass, from its first unit on; else ""
    // Why nodes cannot render the view, each reason with a final "; ". Empty if none is known.
    std::string obstacles(const view::View& view, const NodeRequirements& requirements) const;
    // Why the node gets no work of passes that it could render otherwise; "" = it does.
    std::string idle_reason(const NodeRecord& node) const;
    // Its film has test patterns of null nodes, but now there are nodes that render the scene.
    bool is_superseded(ViewId pass) const;
    std::vector<std::string> left_out(ViewId pass) const;  // "node b (kind X) takes no part: ..."
    std::size_t node_count() const { return nodes_.all().size(); }
    double rate(NodeId node) const { return balancer_.rate(node); }  // pixel samples a second of one worker

    // ---- film: admit(), then the film store merges it and reports to take() ----
    // Whether the node holds or held units that cover it. Nothing: it is dropped; a node that invents film has a fault.
    std::optional<Admission> admit(NodeRecord& node, const wire::FilmHead& head, std::size_t bytes,
                                   TimePoint now);
    // Dropped before it was looked at.
    void malformed_film(NodeRecord& node, const std::string& problem, std::size_t bytes, TimePoint now);
    enum class Taken { Dropped, Known, New };  // New: samples that were not merged before
    Taken take(const MergeReport& report, TimePoint now);
    // The node that sent it, without its work counts; nothing when it has disconnected.
    std::optional<session::NodeSummary> sender(const MergeReport& report) const;

    // ---- events ----
    void collect_overdue(TimePoint now);  // and ends quarantines
    void released(NodeRecord& node, const wire::UnitReleased& release, TimePoint now);
    void goodbye(NodeRecord& node, const wire::Goodbye& goodbye);
    // Unless it was expected, something that it rendered may be the reason.
    enum class Departure {
        Expected,
        Silent,
        Ended  // its process: its connection broke
    };
    void node_gone(NodeId node, Departure departure, TimePoint now);
    void came_back(NodeId former);  // the process of a lost node, which is not the fault of what it rendered
    std::string rendered_by(
        NodeId node) const;  // "; it rendered unit 3 (32x32 pixels at 64,0, samples 0..7)", or ""
    void send_film_taken();  // to nodes whose film was taken since the last call

    // ---- nodes in quarantine ----
    void joined(NodeRecord& node, TimePoint now);
    bool release_from_quarantine(const std::string& name, TimePoint now);
    const Quarantine& quarantine() const { return quarantine_; }

    // ---- counts ----
    session::UnitCounts counts() const;                           // of all passes, including current ones
    std::uint64_t refused_film() const { return refused_film_; }  // malformed, or not asked for
    std::uint64_t contradictions() const { return contradictions_; }
    std::uint64_t verified_units() const { return verified_units_; }
    // From the cancellation to the node's confirmation.
    const Percentiles& cancellations() const { return cancellations_; }

  private:
    struct Active {
        view::View view;
        NodeRequirements requirements;
        Duration hold_film{};
        UnitId first_unit;  // its units have UnitsPerPass ids from this one on
        Scheduler scheduler;
        std::set<std::string> kinds{};   // of nodes whose film is in it
        std::set<NodeId> rendered_by{};  // nodes that have sent film, so that their kernels are compiled
        std::shared_ptr<const view::View> verification{};  // its view, for units that verify film
        bool has_null_film = false, has_other_film = false;
    };
    Active* active(ViewId pass);
    Active* holder(UnitId unit);
    void trace(const view::WorkUnit& unit, NodeId node, std::string text) const;
    bool suits(const NodeRecord& node, const view::View& view, const NodeRequirements& requirements) const;
    void lose(Active& pass, UnitLedger::Loss loss);
    bool ready(const NodeRecord& node, const view::View& view, const NodeRequirements& requirements) const;
    bool may_use_null_nodes(const view::View& view) const;
    std::string why_left_out(const NodeRecord& node, const Active& pass) const;
    void announce_idle(NodeRecord& node);
    Duration allowance(NodeId node) const;
    void announce_stuck(NodeRecord& node, TimePoint now);
    void send_cancellations(const std::vector<Cancellation>& cancellations);
    void confirm_cancelled(UnitId unit, TimePoint now);
    std::uint32_t unexplained_failures(NodeId node) const;
    void fault(NodeRecord& node, const std::string& reason, TimePoint now);
    void start_quarantine(NodeRecord& node, const std::string& reason, TimePoint now);
    void take_explained(Scheduler& scheduler, TimePoint now);
    void take_units_back(const NodeRecord& node, Fate fate);
    void film_is_taken(NodeId node, std::uint64_t bytes);
    void send_work(NodeRecord& node, const view::View& view, Duration hold_film, const view::WorkUnit& unit);
    bool is_to_be_verified(const NodeRecord& node, const Active& pass);
    void verify(Active& pass, const MergeReport& report, const NodeRecord& node, TimePoint now);
    std::optional<Admission> admit_verification(NodeRecord& node, const wire::FilmHead& head,
                                                std::size_t bytes, TimePoint now);
    void take_verification(const MergeReport& report, TimePoint now);
    void condemn(const Verifier::Witness& odd, const std::string& samples, TimePoint now);
    void close_verified_views(NodeRecord& node);
    void report_contradiction(const Active& pass, const MergeReport& report, const NodeRecord& node);

    Duration overdue_patience_;
    const Clock& clock_;
    NodeTable& nodes_;
    Outbox& outbox_;
    EventSink events_;
    Balancer balancer_;
    std::map<ViewId, Active> passes_;
    std::map<UnitId, ViewId> by_first_unit_;
    std::uint64_t next_unit_ = 1;
    session::UnitCounts counts_;  // of passes that have ended
    Quarantine quarantine_;
    Verifier verifier_;
    std::uint64_t refused_film_ = 0, contradictions_ = 0, verified_units_ = 0;
    std::map<UnitId, TimePoint> cancelled_;  // not confirmed yet
    Percentiles cancellations_;
};

}  // namespace tessera::master
