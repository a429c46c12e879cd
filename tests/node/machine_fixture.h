#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "node/node_state_machine.h"
#include "tests/backend/scene_builder.h"

namespace tessera::test {

using std::chrono::milliseconds;
using std::chrono::seconds;

// A state machine with two workers, the master's side of the protocol, and a manual clock.
struct MachineTest : testing::Test {
    static constexpr std::uint64_t Epoch = 1;

    MachineTest() {
        settings.name = "n";
        settings.workers = 2;
        capabilities.channels = {frame::Channel::Radiance};
        capabilities.kind = "test";
        view.id = ViewId{1};
        view.width = view.height = 64;
        view.window = {0, 0, 64, 64};
        view.channels = {frame::Channel::Radiance};
        restart();
    }

    void restart() {
        machine.emplace(settings, capabilities, blobs, now);
        collect();
    }

    // Runs the state machine and stores its actions.
    void collect() {
        machine->tick(now);
        for (node::Action& action : machine->take_actions()) actions.push_back(std::move(action));
        if (machine->state() != node::NodeStateMachine::State::Left)
            EXPECT_GT(machine->next_event(now), now) << "it would not sleep";
    }

    void send(wire::ControlMessage message) {
        machine->control(std::move(message), now);
        collect();
    }

    void pass(Duration time) {
        now += time;
        collect();
    }

    // Removes and returns all actions of a kind.
    template <class A>
    std::vector<A> take() {
        std::vector<A> found;
        std::erase_if(actions, [&](node::Action& action) {
            auto* content = std::get_if<A>(&action);
            if (content) found.push_back(std::move(*content));
            return content != nullptr;
        });
        return found;
    }
    template <class M>
    std::vector<M> sent() {
        std::vector<M> found;
        std::erase_if(actions, [&](node::Action& action) {
            auto* control = std::get_if<node::SendControl>(&action);
            auto* content = control ? std::get_if<M>(&control->message) : nullptr;
            if (content) found.push_back(std::move(*content));
            return content != nullptr;
        });
        return found;
    }
    wire::Heartbeat last_heartbeat() {
        const auto beats = sent<wire::Heartbeat>();
        if (beats.empty()) throw std::logic_error("no heartbeat was sent");
        return beats.back();
    }

    void welcome(std::uint64_t number = 1, std::uint64_t epoch = Epoch) {
        send(wire::Welcome{.peer_number = number,
                           .token = 100 + number,
                           .epoch = epoch,
                           .heartbeat_interval = seconds(1),
                           .missed_heartbeats = 3});
    }

    // Completes the current build successfully.
    void build() {
        ASSERT_EQ(take<node::BuildScene>().size(), 1u);
        machine->built({}, now);
        collect();
    }

    // Welcomed, with the first version built and the view open.
    void synced() {
        welcome();
        send(wire::Changes{builder.edit({scene::Create{scene::RootId, scene::Root{}}})});
        build();
        send(wire::OpenView{view});
        actions.clear();
    }

    view::WorkUnit unit(std::uint64_t id, Version version) const {
        return {.id = UnitId{id},
                .view = view.id,
                .revision = view.revision,
                .version = version,
                .tile = {0, 0, 8, 8},
                .block = {0, 3}};
    }
    view::WorkUnit unit(std::uint64_t id) const { return unit(id, builder.scene().version()); }
    void work(std::uint64_t id) { send(wire::Work{++sequence, unit(id)}); }

    static node::UnitOutcome done(const view::WorkUnit& unit) {
        node::UnitOutcome outcome;
        outcome.result.status = backend::RenderStatus::Done;
        outcome.result.blocks.push_back(frame::FilmTile(unit.tile, unit.block, {frame::Channel::Radiance}));
        return outcome;
    }
    void finish(std::uint64_t id, const frame::SampleBlock& block = {0, 3}) {
        view::WorkUnit finished = unit(id);
        finished.block = block;
        machine->finished(UnitId{id}, done(finished), now);
        collect();
    }

    node::NodeSettings settings;
    backend::Capabilities capabilities;
    std::shared_ptr<scene::BlobStore> blobs = std::make_shared<scene::BlobStore>();
    TimePoint now{seconds(1000)};
    SceneBuilder builder;
    view::View view;
    std::optional<node::NodeStateMachine> machine;
    std::vector<node::Action> actions;
    std::uint64_t sequence = 0;
};

}  // namespace tessera::test
