// Scene updates: change lists, blobs, builds.
#include "mediator/wire/envelope.h"
#include "tests/node/machine_fixture.h"

namespace tessera::node {
namespace {

using State = NodeStateMachine::State;
using test::milliseconds;
using test::seconds;

struct MachineSceneTest : test::MachineTest {
    scene::ChangeList camera(std::uint64_t id) {
        return builder.edit({scene::Create{ObjectId{id}, scene::Camera{}}});
    }
};

TEST_F(MachineSceneTest, ReportsAVersionWhenItIsBuilt) {
    welcome();
    send(wire::Changes{builder.edit({scene::Create{scene::RootId, scene::Root{}}})});
    EXPECT_TRUE(sent<wire::VersionReport>().empty());
    EXPECT_EQ(last_heartbeat().phase, session::NodePhase::Building);
    ASSERT_EQ(take<BuildScene>().size(), 1u);
    BuildOutcome outcome;
    outcome.report = backend::EditReport{.entries = 1, .triangles = 12, .problems = {"a", "b"}};
    outcome.problems = {"b", "c"};
    machine->built(std::move(outcome), now);
    collect();
    const auto reports = sent<wire::VersionReport>();
    ASSERT_EQ(reports.size(), 1u);
    EXPECT_EQ(reports[0].version, builder.scene().version());
    EXPECT_EQ(reports[0].state_hash, builder.scene().state_hash());
    EXPECT_EQ(reports[0].triangles, 12u);
    EXPECT_EQ(reports[0].problems, (std::vector<std::string>{"b", "c", "a"}));
    EXPECT_EQ(machine->state(), State::Idle);
}

TEST_F(MachineSceneTest, AReportHasTheTimesOfItsFirstListAndOfTheBuild) {
    const auto ns = [](TimePoint time) { return time.time_since_epoch().count(); };
    synced();
    const TimePoint first = now;
    send(wire::Changes{camera(50)});
    pass(milliseconds(10));
    const TimePoint second = now;
    send(wire::Changes{camera(51)});  // these two wait for the build of the first
    pass(milliseconds(10));
    send(wire::Changes{camera(52)});
    pass(milliseconds(10));
    build();
    const TimePoint built = now;
    pass(milliseconds(10));
    build();
    const auto reports = sent<wire::VersionReport>();
    ASSERT_EQ(reports.size(), 2u);
    EXPECT_EQ(reports[0].received_at, ns(first));
    EXPECT_EQ(reports[0].built_at, ns(built));
    EXPECT_EQ(reports[1].version, builder.scene().version());
    EXPECT_EQ(reports[1].received_at, ns(second));
    EXPECT_EQ(reports[1].built_at, ns(built + milliseconds(10)));
}

TEST_F(MachineSceneTest, ListsBeforeASnapshotDoNotCountAsReceived) {
    synced();
    send(wire::Changes{camera(50)});
    send(wire::Changes{camera(51)});
    pass(milliseconds(10));
    const scene::ChangeList lost = camera(52);
    send(wire::Changes{camera(53)});  // a gap
    pass(milliseconds(10));
    send(wire::Changes{snapshot(builder.scene())});
    build();  // of 50
    build();
    const auto reports = sent<wire::VersionReport>();
    ASSERT_EQ(reports.size(), 2u);
    EXPECT_EQ(reports[0].received_at, 0);  // not known any more
    EXPECT_EQ(reports[1].received_at, now.time_since_epoch().count());
}

TEST_F(MachineSceneTest, HeartbeatsContinueDuringABuild) {
    welcome();
    send(wire::Changes{builder.edit({scene::Create{scene::RootId, scene::Root{}}})});
    actions.clear();
    for (int i = 0; i < 5; ++i) {
        send(wire::Heartbeat{.sent_at = 1});
        pass(seconds(1));
        EXPECT_EQ(last_heartbeat().phase, session::NodePhase::Building);
    }
}

TEST_F(MachineSceneTest, AGapRequestsOneSnapshotThatRepairsIt) {
    synced();
    camera(50);  // gets lost
    send(wire::Changes{camera(51)});
    const auto resyncs = sent<wire::Resync>();
    ASSERT_EQ(resyncs.size(), 1u);
    EXPECT_EQ(resyncs[0].version.number, 1u);
    send(wire::Changes{camera(52)});
    EXPECT_TRUE(sent<wire::Resync>().empty());
    for (int i = 0; i < 4; ++i) {
        send(wire::Heartbeat{.sent_at = 1});
        pass(seconds(1));
    }
    EXPECT_EQ(sent<wire::Resync>().size(), 1u);  // the request may have got lost too
    send(wire::Changes{snapshot(builder.scene())});
    build();
    EXPECT_EQ(sent<wire::VersionReport>().back().state_hash, builder.scene().state_hash());
    send(wire::Changes{camera(53)});
    build();
    EXPECT_EQ(machine->counters().resyncs, 2u);
}

TEST_F(MachineSceneTest, AnotherEpochIsAResync) {
    synced();
    scene::ChangeList list = camera(50);
    list.from.epoch = list.to.epoch = Epoch + 5;
    send(wire::Changes{list});
    EXPECT_EQ(sent<wire::Resync>().size(), 1u);
    EXPECT_TRUE(take<BuildScene>().empty());
}

TEST_F(MachineSceneTest, ADuplicateIsHarmlessAndReportedAgain) {
    synced();
    const scene::ChangeList list = camera(50);
    send(wire::Changes{list});
    build();
    actions.clear();
    send(wire::Changes{list});
    EXPECT_TRUE(take<BuildScene>().empty());
    EXPECT_TRUE(sent<wire::Resync>().empty());
    EXPECT_EQ(sent<wire::VersionReport>().size(), 1u);
}

TEST_F(MachineSceneTest, AWrongHashIsAResyncAndASecondOneAtTheSameVersionIsRefused) {
    synced();
    scene::ChangeList list = camera(50);
    list.state_hash.low ^= 1;
    send(wire::Changes{list});
    EXPECT_EQ(sent<wire::Resync>().size(), 1u);
    scene::ChangeList wrong = snapshot(builder.scene());
    wrong.state_hash.low ^= 1;
    send(wire::Changes{wrong});
    const auto refused = sent<wire::SceneRefused>();
    ASSERT_EQ(refused.size(), 1u);
    EXPECT_EQ(refused[0].version.number, 2u);
    EXPECT_NE(refused[0].reason.find("check that master and node are the same build"), std::string::npos);
    EXPECT_NE(machine->state(), State::Left) << "the next version may be possible";
    send(wire::Changes{camera(51)});
    send(wire::Changes{snapshot(builder.scene())});
    build();
    EXPECT_EQ(last_heartbeat().version, builder.scene().version());
}

TEST_F(MachineSceneTest, AVersionThatCannotBeBuiltIsReportedAndTheNextOneTried) {
    synced();
    std::uint64_t id = 50;
    for (const ErrorCode code : {ErrorCode::OutOfMemory, ErrorCode::InvalidInput, ErrorCode::Internal}) {
        SCOPED_TRACE(static_cast<int>(code));
        const Version fits = builder.scene().version();
        send(wire::Changes{camera(id++)});
        ASSERT_EQ(take<BuildScene>().size(), 1u);
        const Version too_large = builder.scene().version();
        BuildOutcome outcome;
        outcome.report = failure(code, "3 GiB of 2");
        machine->built(std::move(outcome), now);
        collect();
        const auto refused = sent<wire::SceneRefused>();
        ASSERT_EQ(refused.size(), 1u);
        EXPECT_EQ(refused[0].version, too_large);
        EXPECT_EQ(refused[0].reason, "3 GiB of 2");
        EXPECT_EQ(last_heartbeat().version, fits) << "the back-end keeps the last version that fits";
        for (int i = 0; i < 8; ++i) {
            send(wire::Heartbeat{.sent_at = 1});
            pass(seconds(1));
        }
        EXPECT_TRUE(sent<wire::Resync>().empty()) << "the same version would not fit either";
        EXPECT_EQ(machine->state(), State::Idle);

        send(wire::Changes{camera(id++)});
        ASSERT_EQ(sent<wire::Resync>().size(), 1u);
        send(wire::Changes{snapshot(builder.scene())});
        build();
        EXPECT_EQ(last_heartbeat().version, builder.scene().version());
    }
}

// The master keeps the latest long list only. A node that asks for an older one would wait for ever.
TEST_F(MachineSceneTest, AListThatTheMasterNoLongerKeepsIsReplacedByASnapshot) {
    synced();
    const scene::ChangeList list = camera(50);
    const auto blob = std::make_shared<const scene::Blob>(wire::encode(list));
    send(wire::ChangesByBlob{list.from, list.to, scene::reference(*blob)});
    actions.clear();
    machine->bulk(wire::BlobAbsent{blob->hash()}, now);
    collect();
    ASSERT_EQ(sent<wire::Resync>().size(), 1u) << "at once";
    machine->bulk(wire::BlobAbsent{blob->hash()}, now);
    collect();
    EXPECT_TRUE(sent<wire::Resync>().empty()) << "once";
    send(wire::Changes{snapshot(builder.scene())});
    build();
    EXPECT_EQ(last_heartbeat().version, builder.scene().version());
}

TEST_F(MachineSceneTest, ListsThatCameDuringABuildAreBuiltTogether) {
    synced();
    send(wire::Changes{camera(50)});
    ASSERT_EQ(take<BuildScene>().size(), 1u);
    send(wire::Changes{camera(51)});
    send(wire::Changes{camera(52)});
    EXPECT_TRUE(take<BuildScene>().empty());
    machine->built({}, now);
    collect();
    const auto builds = take<BuildScene>();
    ASSERT_EQ(builds.size(), 1u);
    EXPECT_EQ(builds[0].build.steps.size(), 2u);
}

TEST_F(MachineSceneTest, BlobsAreFetchedBeforeTheBuildAndTheOldVersionIsRenderedMeanwhile) {
    synced();
    const auto blob = std::make_shared<const scene::Blob>(std::vector<std::byte>(300));
    scene::Geometry geometry;
    geometry.positions = reference(*blob);
    const Version old = builder.scene().version();
    send(wire::Changes{builder.edit({scene::Create{ObjectId{60}, geometry}})});
    EXPECT_TRUE(take<BuildScene>().empty());
    EXPECT_EQ(last_heartbeat().phase, session::NodePhase::Syncing);
    const auto requests = take<SendBulk>();
    ASSERT_EQ(requests.size(), 1u);
    EXPECT_EQ(std::get<wire::BlobRequest>(requests[0].message).hash, blob->hash());

    send(wire::Work{++sequence, unit(1, old)});
    EXPECT_EQ(take<Render>().size(), 1u);

    machine->bulk(wire::BlobChunk{blob->hash(), 300, 0, {blob->bytes().begin(), blob->bytes().end()}}, now);
    collect();
    const auto builds = take<BuildScene>();
    ASSERT_EQ(builds.size(), 1u);
    ASSERT_EQ(builds[0].build.unchecked.size(), 1u);
    EXPECT_EQ(builds[0].build.unchecked[0], ObjectId{60});
}

TEST_F(MachineSceneTest, ABlobThatTheMasterLacksIsRequestedAgain) {
    synced();
    const auto blob = std::make_shared<const scene::Blob>(std::vector<std::byte>(300));
    scene::Geometry geometry;
    geometry.positions = reference(*blob);
    send(wire::Changes{builder.edit({scene::Create{ObjectId{60}, geometry}})});
    ASSERT_EQ(take<SendBulk>().size(), 1u);
    machine->bulk(wire::BlobAbsent{blob->hash()}, now);
    collect();
    EXPECT_TRUE(take<SendBulk>().empty());
    send(wire::Heartbeat{.sent_at = 1});
    pass(seconds(1));
    std::size_t requests = 0;
    for (const SendBulk& action : take<SendBulk>())
        requests += std::holds_alternative<wire::BlobRequest>(action.message);
    ASSERT_EQ(requests, 1u);
    machine->bulk(wire::BlobChunk{blob->hash(), 300, 0, {blob->bytes().begin(), blob->bytes().end()}}, now);
    collect();
    EXPECT_EQ(take<BuildScene>().size(), 1u);
}

TEST_F(MachineSceneTest, ASnapshotByBlobIsFetchedReadAndBuilt) {
    welcome();
    builder.edit({scene::Create{scene::RootId, scene::Root{}}});
    camera(50);
    const auto blob = std::make_shared<const scene::Blob>(wire::encode(snapshot(builder.scene())));
    const wire::ChangesByBlob announced{{Epoch, 0}, builder.scene().version(), reference(*blob)};
    send(announced);
    EXPECT_TRUE(take<BuildScene>().empty());
    send(wire::Changes{camera(51)});  // overtakes nothing: its turn comes after the blob's
    blobs->insert(blob);
    pass(Duration(1));
    const auto builds = take<BuildScene>();
    ASSERT_EQ(builds.size(), 1u);
    EXPECT_EQ(builds[0].build.steps.size(), 2u);
    EXPECT_EQ(builds[0].build.scene().version(), builder.scene().version());
}

TEST_F(MachineSceneTest, ABlobThatIsNotAChangeListIsAResync) {
    welcome();
    const auto blob = std::make_shared<const scene::Blob>(std::vector<std::byte>(100, std::byte{0xee}));
    blobs->insert(blob);
    send(wire::ChangesByBlob{{Epoch, 0}, {Epoch, 7}, reference(*blob)});
    EXPECT_EQ(sent<wire::Resync>().size(), 1u);
}

TEST_F(MachineSceneTest, TheCacheIsSearchedFirst) {
    settings.cache = "somewhere";
    restart();
    synced();
    const auto blob = std::make_shared<const scene::Blob>(std::vector<std::byte>(300));
    scene::Geometry geometry;
    geometry.positions = reference(*blob);
    send(wire::Changes{builder.edit({scene::Create{ObjectId{60}, geometry}})});
    const auto loads = take<LoadBlobs>();
    ASSERT_EQ(loads.size(), 1u);
    EXPECT_TRUE(take<SendBulk>().empty());
    machine->looked_up(loads[0].blobs, now);
    collect();
    ASSERT_EQ(take<SendBulk>().size(), 1u);
    machine->bulk(wire::BlobChunk{blob->hash(), 300, 0, {blob->bytes().begin(), blob->bytes().end()}}, now);
    collect();
    EXPECT_EQ(take<SaveBlob>().size(), 1u);
    EXPECT_EQ(take<BuildScene>().size(), 1u);
}

}  // namespace
}  // namespace tessera::node
