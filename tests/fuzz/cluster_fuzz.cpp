#include "tests/fuzz/cluster_fuzz.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdio>
#include <deque>
#include <fstream>
#include <functional>
#include <future>
#include <map>
#include <optional>
#include <thread>

#include "client/render.h"
#include "mediator/frame/resolve.h"
#include "mediator/scene/fields.h"
#include "tests/cluster/cluster_scene.h"
#include "tests/cluster/loopback_cluster.h"
#include "tests/fuzz/faults.h"
#include "tests/fuzz/random_peer.h"

namespace tessera::test {

namespace {

using namespace scene;
using namespace std::chrono_literals;
namespace fs = std::filesystem;

constexpr net::Role Roles[] = {net::Role::Viewer, net::Role::Editor, net::Role::Node, net::Role::Operator};

// Every other frame gets its samples where they are needed, of about as many.
constexpr std::array StopRules{session::StopRule{.spp = 64}, session::StopRule{.spp = 1024, .noise = 0.1},
                               session::StopRule{.spp = 1024, .error = 0.01}};

session::ViewRequest honest_request(const session::StopRule& stop) {
    session::ViewRequest request{.stop = stop, .wait_limit = 120s, .film = true};
    request.view.width = 96;
    request.view.height = 64;
    request.view.window = {0, 0, 96, 64};
    request.view.camera = view::perspective(glm::dmat4(1.0), 0.8, 1.5);
    request.view.channels = {frame::Channel::Radiance, frame::Channel::Albedo};
    if (stop.error > 0.0) request.view.filter = "gauss";
    return request;
}

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool IsSanitized = true;  // needs several times the memory
#else
constexpr bool IsSanitized = false;
#endif

// Of this process, at most until now. Linux.
std::uint64_t peak_memory() {
    std::ifstream status("/proc/self/status");
    for (std::string word; status >> word;) {
        if (std::uint64_t kib = 0; word == "VmHWM:" && status >> kib) return kib << 10;
    }
    return 0;
}

class Fuzz {
  public:
    explicit Fuzz(const FuzzSettings& settings) : settings_(settings), random_(settings.seed, 1) {
        fs::remove_all(folder_);
    }
    ~Fuzz() {
        cluster_.reset();
        fs::remove_all(folder_);
    }

    FuzzReport run() {
        std::ranges::transform(StopRules, expected_.begin(), honest_hash);
        start();
        for (bool restarts = false; sent() < settings_.messages && report_.violations.empty();
             restarts = !restarts) {
            try {
                edit_among_peers(restarts);
                if (report_.violations.empty()) render_among_peers();
            } catch (const std::exception& error) {
                violated(std::string("an honest client: ") + error.what());
            }
        }
        peers_.clear();
        cluster_.reset();
        check_traffic();
        return report_;
    }

  private:
    void violated(const std::string& what) {
        report_.violations.push_back(what);
        std::fprintf(stderr, "seed %llu: %s\n", static_cast<unsigned long long>(settings_.seed),
                     what.c_str());
    }
    // A thread waits for an answer and cannot be ended.
    [[noreturn]] void end_at_once(const std::string& what) {
        violated(what);
        fs::remove_all(folder_);
        std::quick_exit(1);
    }
    static std::string honest_hash(const session::StopRule& stop) {
        LoopbackCluster honest;
        honest.add_node("null");
        const auto session = honest.batch(std::make_shared<BlobStore>());
        return to_hex(frame::film_hash(*client::render(*session, honest_request(stop), {}, {}).film()));
    }

    void start() {
        cluster_.emplace([&](master::MasterSettings& master) {
            master.stuck = {.allowance = 1s, .predicted_times = 20, .first_film = 5s, .building = 5s};
            master.memory_limit = MemoryLimit;
            master.views.orphan_limit = 1s;
            master.session_folder = folder_;
            master.checkpoint_interval = 200ms;
        });
        links_.clear();
        highest_unit_ = 0;
        for (int i = 0; i < 2; ++i) add_node();
    }
    void add_node() {
        links_.emplace_back();
        cluster_->add_node(links_.back(), 5us);
    }
    std::uint64_t sent() const { return traffic_.total(); }

    void add_peers(bool join, bool forge) {
        for (std::size_t i = 0; i < settings_.peers; ++i) {
            const net::Role role = Roles[i % std::size(Roles)];
            const std::string name = std::string(net::name(role)) + " " + std::to_string(i);
            peers_.push_back(std::make_unique<RandomPeer>(
                cluster_->channel(role, name), RandomPeer::Settings{role, name, join, forge, honest_id_},
                traffic_, highest_unit_, random_.below(~0ull)));
        }
    }
    // As many messages as the peers get rid of, among faults, with this pause for each on average; `done` ends it earlier.
    void send(std::uint64_t messages, Faults& faults, Duration pause, const std::function<bool()>& done) {
        constexpr unsigned Burst = 8;
        unsigned sent_since_pause = 0;
        std::uint64_t idle = 0;
        const std::uint64_t end = sent() + messages;
        while (sent() < end && !done()) {
            RandomPeer& peer = *peers_[random_.below(peers_.size())];
            if (peer.act()) {
                idle = 0;
                faults.step(links_.front(), links_.back());
                if (pause > Duration{} && ++sent_since_pause == Burst) {
                    sent_since_pause = 0;
                    std::this_thread::sleep_for(Burst * pause);
                }
            } else if (++idle > peers_.size()) {
                std::this_thread::sleep_for(1ms);
                idle = 0;
            }
            if (random_.below(2000) == 0) {
                faults.heal();
                cluster_->remove_newest_node();
                add_node();
            }
        }
        faults.heal();
        report_.faults += faults.count();
        for (const auto& peer : peers_) {
            report_.reached += peer->reached();
            if (!peer->leak().empty()) violated("a viewer got " + peer->leak());
        }
    }
    void remove_peers() {
        for (const auto& peer : peers_) {
            if (random_.below(2) == 0) peer->say_goodbye();  // others vanish
        }
        peers_.clear();
    }

    // ---- the live scene ----
    void edit_among_peers(bool restarts) {
        const auto blobs = std::make_shared<BlobStore>();
        auto ann = cluster_->member("ann", blobs);
        const ObjectId first = ann->new_id();
        for (int i = 0; i < 3; ++i) (void)ann->new_id();
        if (!ann->submit(scene_entries(first, *blobs)).accepted) return violated("the scene is refused");
        honest_id_ = ann->new_id();
        std::vector<ObjectId> mine{honest_id_};
        for (int i = 0; i < 7; ++i) mine.push_back(ann->new_id());
        std::vector<Entry> creations;
        for (const ObjectId id : mine) creations.push_back(Create{id, Material{.name = "mine"}});
        if (!ann->submit(std::move(creations)).accepted) return violated("an honest edit is refused");
        std::map<ObjectId, float> acknowledged;
        edit_among_peers(*ann, mine, acknowledged);
        if (restarts && report_.violations.empty()) {
            ann.reset();
            cluster_.reset();
            start();
            ann = cluster_->member("ann", blobs);
            check_scene(*ann, acknowledged);
            edit_among_peers(*ann, mine, acknowledged);
        }
        if (!report_.violations.empty()) return;
        ann->close_scene();
        check_units(*ann);
    }
    void edit_among_peers(client::Session& ann, const std::vector<ObjectId>& mine,
                          std::map<ObjectId, float>& acknowledged) {
        Faults faults(folder_, random_.below(~0ull));
        std::atomic<bool> stop = false;
        ann.lock(mine);
        add_peers(true, true);
        auto editing = std::async(std::launch::async, [&] { edit(ann, mine, acknowledged, faults, stop); });
        // Versions are published and superseded in the pauses.
        send(settings_.messages / 8 + 1, faults, 400us, [] { return false; });
        stop = true;
        if (editing.wait_for(60s) != std::future_status::ready)
            end_at_once("an honest edit got no answer for 60 s");
        editing.get();
        check_scene(ann, acknowledged);
        remove_peers();
        check_nodes(ann);
    }
    // Of locked objects; at times also a long edit, which nodes get as a blob.
    void edit(client::Session& ann, const std::vector<ObjectId>& mine,
              std::map<ObjectId, float>& acknowledged, const Faults& faults, const std::atomic<bool>& stop) {
        constexpr std::size_t LongEdit = 3;
        std::vector<ObjectId> others;
        for (std::size_t step = 1; !stop; ++step) {
            // Without, virtual time would stand still: there would always be an edit to answer.
            std::this_thread::sleep_for(10ms);
            if (step % LongEdit == 0) edit_many(ann, others);
            const ObjectId id = mine[step % mine.size()];
            const float roughness = static_cast<float>(step % 1000) / 1000.0f;
            const std::uint64_t disk = faults.disk_changes();
            const auto result = ann.submit({Update{id, Fields<Material>(&Material::roughness).bits(),
                                                   Material{.roughness = roughness}}});
            const bool disk_was_full = disk % 2 == 1 || faults.disk_changes() != disk;
            if (!result.accepted && !disk_was_full) throw Error(ErrorCode::Refused, result.problems.at(0));
            if (result.accepted) acknowledged[id] = roughness;
            report_.edits += result.accepted ? 1 : 0;
        }
    }
    // Creates objects, or removes those of the last time. Peers may undo it, since they are not locked.
    static void edit_many(client::Session& ann, std::vector<ObjectId>& objects) {
        constexpr std::size_t Count = 600;
        std::vector<Entry> entries;
        if (objects.empty()) {
            for (std::size_t i = 0; i < Count; ++i) objects.push_back(ann.new_id());
            for (const ObjectId id : objects) entries.emplace_back(Create{id, Transform{}});
        } else {
            for (const ObjectId id : std::exchange(objects, {})) entries.emplace_back(Remove{id});
        }
        if (!ann.submit(std::move(entries)).accepted) objects.clear();
        ann.refresh();  // waits until it is published
    }
    // No acknowledged edit is lost, and every replica is the authority's scene.
    void check_scene(client::Session& ann, const std::map<ObjectId, float>& acknowledged) {
        ann.refresh();
        for (const auto& [id, roughness] : acknowledged) {
            const auto* material = ann.scene().find_as<Material>(id);
            if (material == nullptr || material->roughness != roughness)
                violated("an acknowledged edit of object " + std::to_string(id.value) + " is lost");
        }
        const auto late = cluster_->member("late", std::make_shared<BlobStore>());
        for (int i = 0; i < 100 && late->scene().version() != ann.scene().version(); ++i) {
            ann.refresh();
            late->refresh();
        }
        if (late->scene().state_hash() != ann.scene().state_hash())
            violated("a late reader has another scene than one who followed all changes");
    }
    template <class Settled>
    static session::ClusterStatus status_when(client::Session& session, const Settled& settled) {
        session::ClusterStatus status = session.status();
        for (int i = 0; i < 1000 && !settled(status); ++i) {
            std::this_thread::sleep_for(10ms);
            status = session.status();
        }
        return status;
    }
    // Once the peers are gone, which takes until their timeouts.
    void check_nodes(client::Session& session) {
        const session::ClusterStatus status = status_when(session, [](const session::ClusterStatus& at) {
            return at.sessions == 1 && at.nodes.size() == 2 &&
                   std::ranges::all_of(at.nodes,
                                       [&](const auto& node) { return node.version == at.version; });
        });
        if (status.sessions != 1)
            violated(std::to_string(status.sessions - 1) + " clients that are gone are still there");
        if (status.nodes.size() != 2) violated(std::to_string(status.nodes.size()) + " nodes instead of 2");
        for (const session::NodeStatus& node : status.nodes) {
            if (node.version != status.version)
                violated("node " + node.summary.name + " does not reach the published version");
        }
        for (const std::string& event : cluster_->events()) {
            if (event.starts_with("node node-") && event.find("cannot build version") != std::string::npos)
                violated("the master accepted what nodes refuse: " + event);
        }
        if (status.caught_exceptions != 0)
            violated("the master caught " + std::to_string(status.caught_exceptions) + " exceptions");
        // LoopSteps asserts 20 ms; here all other threads of the cluster share its caches.
        constexpr double LongStep = 0.040;
        if (!IsSanitized && status.loop.longest_cpu_seconds > LongStep)
            violated("a step of the loop took " + std::to_string(status.loop.longest_cpu_seconds) + " s (" +
                     status.loop.longest_part + ")");
        if (status.loop.longest_cpu_seconds < report_.longest_step_cpu) return;
        report_.longest_step_cpu = status.loop.longest_cpu_seconds;
        report_.longest_part = status.loop.longest_part;
    }
    // No view is open any more.
    void check_units(client::Session& session) {
        const auto ended = [](const session::UnitCounts& units) {
            return units.merged + units.duplicate + units.cancelled + units.refused + units.lost;
        };
        const session::UnitCounts units = session.status().units;
        if (units.issued + units.reissued != ended(units))
            violated("of " + std::to_string(units.issued + units.reissued) + " units " +
                     std::to_string(ended(units)) + " are accounted for");
    }

    // Of everything that all peers have sent.
    void check_traffic() {
        report_.messages = sent();
        report_.peak_memory = peak_memory();
        // In addition to what the master may use: for nodes, honest clients, long edits that peers prepare.
        constexpr std::uint64_t Rest = std::uint64_t{384} << 20;
        if (!IsSanitized && report_.peak_memory > MemoryLimit + Rest)
            violated(std::to_string(report_.peak_memory >> 20) + " MiB of memory");
        constexpr std::uint64_t Enough = 10'000;
        if (sent() < Enough) return;
        for (const std::string_view kind : RandomPeer::kinds(Roles)) {
            if (traffic_.share(kind) < 0.01)
                violated("less than 1 % of the messages are " + std::string(kind));
        }
    }

    // ---- a frame of an exclusive scene ----
    void render_among_peers() {
        const auto session = cluster_->batch(std::make_shared<BlobStore>());
        add_peers(false, false);
        const std::size_t which = report_.frames % StopRules.size();
        auto rendering = std::async(std::launch::async, [&] {
            return client::render(*session, honest_request(StopRules[which]), {}, {});
        });
        Faults faults(folder_, random_.below(~0ull));
        const auto done = [&] { return rendering.wait_for(0s) == std::future_status::ready; };
        send(settings_.messages / 8 + 1, faults, {}, done);
        if (rendering.wait_for(120s) != std::future_status::ready)
            end_at_once("an honest frame did not end within 120 s");
        const client::ViewResult result = rendering.get();
        if (result.summary.outcome != session::Outcome::Complete) {
            violated("the honest frame: " + result.summary.message);
        } else if (to_hex(frame::film_hash(*result.film())) != expected_[which]) {
            violated("the honest frame has other bits");
        }
        ++report_.frames;
        remove_peers();
    }

    // Far above what honest peers need, far below what peers can make of a few messages.
    static constexpr std::uint64_t MemoryLimit = std::uint64_t{128} << 20;

    const fs::path folder_ = fs::temp_directory_path() / ("tessera-fuzz-" + std::to_string(::getpid()));
    FuzzSettings settings_;
    CounterRandom random_;
    Traffic traffic_;
    std::uint64_t highest_unit_ = 0;  // that a peer knows of
    std::deque<LinkSwitch> links_;    // of the honest nodes; the first and the last are in use
    std::optional<LoopbackCluster> cluster_;
    std::vector<std::unique_ptr<RandomPeer>> peers_;
    ObjectId honest_id_{};
    std::array<std::string, StopRules.size()> expected_;
    FuzzReport report_;
};

}  // namespace

FuzzReport fuzz_cluster(const FuzzSettings& settings) {
    return Fuzz(settings).run();
}

}  // namespace tessera::test
