#include "node/render_node.h"

#include <algorithm>
#include <thread>

#include "mediator/base/task_thread.h"
#include "mediator/scene/validate.h"
#include "mediator/wire/envelope.h"
#include "mediator/wire/peer_texts.h"
#include "node/blob_cache.h"
#include "node/outbox.h"
#include "node/worker_pool.h"

namespace tessera::node {

namespace {

constexpr int BurstLimit = 256;  // messages handled between checks of the heartbeats
constexpr Duration BlockedPause = std::chrono::milliseconds(2);
constexpr Duration FlushLimit = std::chrono::seconds(1);

BuildOutcome build(backend::Backend& backend, const scene::BlobStore& blobs,
                   const SceneReplica::Build& build) {
    BuildOutcome outcome;
    for (const ObjectId id : build.unchecked) {
        for (scene::Problem& problem : scene::validate_blobs(id, *build.scene().find(id), blobs)) {
            outcome.problems.push_back(std::move(problem.message));
        }
    }
    try {
        const std::unique_ptr<backend::EditScope> scope = backend.begin_edit();
        for (const SceneReplica::Step& step : build.steps) {
            if (const Expected<void> applied = scope->apply(step.list, step.after); !applied) {
                outcome.report = tl::unexpected(applied.error());
                return outcome;
            }
        }
        outcome.report = scope->commit();
    } catch (const Error& error) {
        outcome.report = tl::unexpected(error);
    } catch (const std::exception& error) {
        outcome.report = failure(ErrorCode::Internal, error.what());
    }
    return outcome;
}

}  // namespace

// One run: the state machine, the threads it drives, and the events between them.
class RenderNode::Loop {
  public:
    Loop(RenderNode& node, const backend::Capabilities& capabilities)
        : node_(node),
          machine_(node.settings_, capabilities, node.blobs_, node.clock_.now()),
          outbox_(*node.channel_),
          builder_(),
          cache_thread_(),
          workers_(
              *node.backend_, node.clock_,
              std::max(1u, node.settings_.workers ? node.settings_.workers : capabilities.concurrent_units),
              [&node](UnitId unit, UnitOutcome&& outcome) {
                  node.post(FinishedUnit{unit, std::move(outcome)});
              }) {}

    NodeResult run(const std::stop_token& drain, const std::stop_token& at_once) {
        bool asked = false;
        while (machine_.state() != NodeStateMachine::State::Left) {
            if (drain.stop_requested() && !std::exchange(asked, true)) {
                machine_.leave("asked to stop", node_.settings_.drain, node_.clock_.now());
            }
            if (at_once.stop_requested()) {
                for (int i = 0; i < 2; ++i)
                    machine_.leave("asked to stop immediately", node_.settings_.drain, node_.clock_.now());
                asked = true;
            }
            take_events();
            act();
            if (machine_.state() != NodeStateMachine::State::Left) receive();
        }
        act();
        flush_before_leaving();
        return {machine_.failure_text(), machine_.counters()};
    }

  private:
    void take_events() {
        for (Event& event : node_.take_events()) {
            const TimePoint now = node_.clock_.now();
            if (auto* unit = std::get_if<FinishedUnit>(&event)) {
                machine_.finished(unit->unit, std::move(unit->outcome), now);
            } else if (auto* built = std::get_if<BuildOutcome>(&event)) {
                machine_.built(std::move(*built), now);
                trim_store();
            } else {
                machine_.looked_up(std::get<LookedUp>(event).blobs, now);
            }
        }
    }

    void act() {
        for (bool film_went = true; film_went || std::exchange(film_withdrawn_, false);) {
            machine_.tick(node_.clock_.now());
            for (Action& action : machine_.take_actions()) {
                std::visit([this](auto& what) { perform(what); }, action);
            }
            const std::vector<UnitId> sent = outbox_.flush(node_.clock_.now());
            for (const UnitId unit : sent) machine_.film_sent(unit);
            film_went = !sent.empty();
        }
    }

    void receive() {
        TimePoint now = node_.clock_.now();
        TimePoint deadline = machine_.next_event(now);
        if (outbox_.blocked()) deadline = std::min(deadline, now + BlockedPause);
        for (int i = 0; i < BurstLimit; ++i) {
            net::Received received = node_.channel_->receive(deadline);
            now = node_.clock_.now();
            deadline = now;  // after the first one take only messages that have already arrived
            if (const auto* none = std::get_if<net::NoMessage>(&received)) {
                if (*none == net::NoMessage::Closed)
                    std::this_thread::sleep_for(BlockedPause);  // until the liveness timeout
                return;
            }
            take(std::get<net::Message>(received), now);
        }
    }

    void take(const net::Message& message, TimePoint now) {
        if (message.link == net::Link::Control) {
            Expected<wire::ControlMessage> decoded = wire::decode_control(message.bytes);
            if (!decoded) return machine_.malformed(decoded.error().what(), now);
            machine_.control(std::move(*decoded), now);
        } else {
            Expected<wire::BulkMessage> decoded = wire::decode_bulk(message.bytes);
            if (!decoded) return machine_.malformed(decoded.error().what(), now);
            machine_.bulk(std::move(*decoded), now);
        }
    }

    void perform(SendControl& send) {
        wire::shorten_texts(send.message);
        outbox_.control(wire::encode(send.message));
    }
    void perform(SendBulk& send) { outbox_.bulk(wire::encode(send.message)); }
    void perform(SendFilm& film) {
        std::vector<net::Bytes> parts;
        for (wire::FilmPart& part : film.parts)
            parts.push_back(wire::encode(wire::BulkMessage(std::move(part))));
        outbox_.film(std::move(film.units), std::move(parts));
    }
    void perform(WithdrawFilm& film) {
        for (const UnitId unit : outbox_.withdraw(film.unit)) {
            machine_.film_withdrawn(unit);
            film_withdrawn_ = true;
        }
    }
    void perform(FilmTaken& taken) { outbox_.film_taken(taken.bytes, node_.clock_.now()); }
    void perform(OpenBulk& open) {
        outbox_.open(wire::encode(wire::BulkMessage(wire::BulkHello{open.token})));
    }
    void perform(DiscardPendingFilm&) { outbox_.discard_pending_film(); }
    void perform(PauseBulk&) { outbox_.hold(); }
    void perform(Reconnect&) {
        outbox_.hold();
        if (node_.callbacks_.reconnect) node_.callbacks_.reconnect();
    }
    void perform(Render& render) { workers_.start(render.view, render.unit); }
    void perform(StopUnit& stop) { workers_.stop(stop.unit); }
    void perform(BuildScene& task) {
        builder_.post([&node = node_, what = std::move(task.build)] {
            node.post(build(*node.backend_, *node.blobs_, what));
        });
    }
    void perform(LoadBlobs& load) {
        cache_thread_.post([&node = node_, cache = node_.cache_, blobs = std::move(load.blobs)] {
            for (const scene::BlobRef& blob : blobs) {
                if (scene::BlobPtr found = cache->load(blob)) node.blobs_->insert(std::move(found));
            }
            node.post(LookedUp{blobs});
        });
    }
    void perform(SaveBlob& save) {
        cache_thread_.post([cache = node_.cache_, blob = std::move(save.blob)] { cache->save(*blob); });
    }
    void perform(Report& report) {
        if (node_.callbacks_.event) node_.callbacks_.event(report);
    }

    // Only the back-end may still use blobs that the current scene does not refer to; a private store is kept small.
    void trim_store() {
        const std::uint64_t limit = node_.settings_.store_limit;
        if (limit == 0 || node_.blobs_->byte_size() <= limit || machine_.replica().is_behind()) return;
        std::vector<scene::BlobPtr> in_use;
        for (const scene::BlobRef& blob : scene::referenced_blobs(machine_.replica().scene())) {
            in_use.push_back(node_.blobs_->find(blob.hash));
        }
        node_.blobs_->erase_unused();
    }

    void flush_before_leaving() {
        const TimePoint limit = node_.clock_.now() + FlushLimit;
        while (outbox_.blocked() && node_.clock_.now() < limit) {
            std::this_thread::sleep_for(BlockedPause);
            (void)outbox_.flush(node_.clock_.now());
        }
    }

    RenderNode& node_;
    NodeStateMachine machine_;
    Outbox outbox_;
    bool film_withdrawn_ = false;  // the machine has actions about it
    TaskThread builder_;
    TaskThread cache_thread_;  // for disk access, so that builds do not wait for saves
    WorkerPool workers_;       // destroyed first: a build waits for the units being rendered
};

RenderNode::RenderNode(std::unique_ptr<net::Channel> channel, std::unique_ptr<backend::Backend> backend,
                       std::shared_ptr<scene::BlobStore> blobs, const Clock& clock,
                       const NodeSettings& settings, NodeCallbacks callbacks)
    : channel_(std::move(channel)),
      backend_(std::move(backend)),
      blobs_(std::move(blobs)),
      clock_(clock),
      settings_(settings),
      callbacks_(std::move(callbacks)) {
    if (settings_.cache) cache_ = std::make_shared<BlobCache>(*settings_.cache, settings_.cache_limit);
}

RenderNode::~RenderNode() = default;

NodeResult RenderNode::run(std::stop_token drain, std::stop_token at_once) {
    const std::stop_callback wake_on_drain(drain, [this] { channel_->wake(); });
    const std::stop_callback wake_on_leave(at_once, [this] { channel_->wake(); });
    NodeResult result = Loop(*this, backend_->capabilities()).run(drain, at_once);
    channel_->close();
    return result;
}

void RenderNode::post(Event&& event) {
    {
        const std::scoped_lock lock(mutex_);
        events_.push_back(std::move(event));
    }
    channel_->wake();
}

std::vector<RenderNode::Event> RenderNode::take_events() {
    const std::scoped_lock lock(mutex_);
    return std::exchange(events_, {});
}

}  // namespace tessera::node
