#include "tests/cluster/loopback_cluster.h"

#include "mediator/backend/catalog.h"
#include "tests/cluster/cluster_scene.h"

namespace tessera::test {

namespace {

// Short, so that a lost node is detected quickly; long enough for a busy machine.
net::LivenessSettings quick_heartbeats() {
    return {.interval = std::chrono::milliseconds(100), .missed = 10};
}

}  // namespace

LoopbackCluster::LoopbackCluster(const std::function<void(master::MasterSettings&)>& adjust,
                                 Transport transport)
    : hub_(net::LoopbackHub::Limits{.messages_per_queue = 4096}) {
    master::MasterSettings settings{.software = "test"};
    settings.liveness = quick_heartbeats();
    settings.collect_interval = std::chrono::milliseconds(50);
    settings.views.overdue_patience = std::chrono::seconds(1);
    if (adjust) adjust(settings);
    std::unique_ptr<net::Channel> server;
    if (transport == Transport::ZeroMQ) {
        static std::atomic<int> number = 0;
        sockets_ = net::make_zmq_context();
        endpoint_ = "inproc://cluster-" + std::to_string(++number);
        server = net::make_zmq_server(sockets_, {.endpoint = endpoint_, .keys = {}});
    } else {
        server = hub_.server();
    }
    master_ = std::make_unique<master::RenderMaster>(std::move(server), std::make_shared<scene::BlobStore>(),
                                                     clock_, settings, [this](const master::Event& event) {
                                                         const std::scoped_lock lock(mutex_);
                                                         events_.push_back(event.text);
                                                     });
    master_thread_ = std::jthread([this](std::stop_token stop) { master_->run(stop); });
}

LoopbackCluster::~LoopbackCluster() {
    for (std::jthread& thread : node_threads_) thread.request_stop();
    node_threads_.clear();
}

std::unique_ptr<net::Channel> LoopbackCluster::channel(net::Role role, const std::string& user) {
    if (sockets_) return net::make_zmq_client(sockets_, {.endpoint = endpoint_, .keys = {}});
    return hub_.client(role, user);
}

void LoopbackCluster::add_node(const std::string& backend, const NodeFaults& faults, Duration cost) {
    auto blobs = std::make_shared<scene::BlobStore>();
    auto made =
        backend::find_backend(backend).make({.threads = 1, .simulated_sample_cost = cost, .blobs = blobs});
    start_node(backend, std::move(made), blobs,
               net::with_faults(channel(net::Role::Node), faults.control, faults.bulk));
}

void LoopbackCluster::add_node(const MakeBackend& make) {
    auto blobs = std::make_shared<scene::BlobStore>();
    start_node("test", make({.threads = 1, .blobs = blobs}), blobs, channel(net::Role::Node));
}

void LoopbackCluster::add_node(LinkSwitch& link, Duration cost) {
    auto blobs = std::make_shared<scene::BlobStore>();
    auto made =
        backend::find_backend("null").make({.threads = 1, .simulated_sample_cost = cost, .blobs = blobs});
    start_node("null", std::move(made), blobs, link.channel([this] { return channel(net::Role::Node); }),
               [&link] { link.reconnect(); });
}

void LoopbackCluster::remove_newest_node() {
    node_threads_.back().request_stop();
    node_threads_.pop_back();
    nodes_.pop_back();
}

void LoopbackCluster::start_node(const std::string& kind, std::unique_ptr<backend::Backend> made,
                                 const std::shared_ptr<scene::BlobStore>& blobs,
                                 std::unique_ptr<net::Channel> channel, std::function<void()> reconnect) {
    node::NodeSettings settings{
        .name = "node-" + std::to_string(++started_nodes_), .backend = kind, .workers = 1};
    settings.liveness = quick_heartbeats();
    settings.reproducible = kind != "embree";  // needs no pinning
    nodes_.push_back(std::make_unique<node::RenderNode>(
        std::move(channel), std::move(made), blobs, clock_, settings,
        node::NodeCallbacks{.event = [](const node::Report&) {}, .reconnect = std::move(reconnect)}));
    node::RenderNode& node = *nodes_.back();
    node_threads_.emplace_back([&node](std::stop_token stop) {
        // At once: a node whose channel is cut could wait for ever for its goodbye to be received.
        node.run(stop, stop);
    });
}

std::unique_ptr<client::Session> LoopbackCluster::session(std::shared_ptr<scene::BlobStore> blobs,
                                                          net::Role role, const std::string& user) {
    return client::make_session(channel(role, user), nullptr, std::move(blobs), clock_, {.name = "test"});
}

std::unique_ptr<client::Session> LoopbackCluster::batch(const std::shared_ptr<scene::BlobStore>& blobs) {
    auto made = session(blobs);
    const auto joined = made->join({.title = "test", .exclusive = true}, {});
    const auto edit = made->submit(scene_entries(std::get<client::Joined>(joined).first_id, *blobs));
    if (!edit.accepted) throw Error(ErrorCode::Internal, edit.problems.front());
    return made;
}

std::unique_ptr<client::Session> LoopbackCluster::member(const std::string& name,
                                                         std::shared_ptr<scene::BlobStore> blobs,
                                                         net::Role role, const std::string& user) {
    auto made = client::make_session(channel(role, user), nullptr, std::move(blobs), clock_, {.name = name});
    made->join({.title = "test"}, {});
    return made;
}

std::vector<std::string> LoopbackCluster::events() const {
    const std::scoped_lock lock(mutex_);
    return events_;
}

}  // namespace tessera::test
