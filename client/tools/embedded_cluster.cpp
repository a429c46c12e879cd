#include "client/tools/embedded_cluster.h"

#include <unistd.h>

#include <algorithm>

#include "client/tools/host_info.h"
#include "mediator/backend/catalog.h"
#include "mediator/program/command_line.h"

namespace tessera::tools {

namespace {

constexpr const char* Endpoint = "inproc://tessera";

// Within one process, missed heartbeats mean a busy machine, not a lost peer.
constexpr std::uint32_t PatientHeartbeats = 600;

}  // namespace

EmbeddedCluster::EmbeddedCluster(const EmbeddedSettings& settings, std::shared_ptr<scene::BlobStore> blobs,
                                 const Clock& clock, master::EventSink events)
    : context_(net::make_zmq_context()),
      events_([this, events = std::move(events)](const master::Event& event) {
          if (!is_stopping_) events(event);
      }) {
    master::MasterSettings master_settings{.software = "tessera " + cli::version()};
    master_settings.liveness.missed = PatientHeartbeats;
    master_settings.collect_interval = Duration::zero();  // the store is also the client's and the nodes'
    master_ = std::make_unique<master::RenderMaster>(
        net::make_zmq_server(context_, {.endpoint = Endpoint, .keys = {}}), blobs, clock, master_settings,
        events_);
    for (std::uint32_t i = 0; i < settings.nodes; ++i) add_node(settings, i, blobs, clock);

    master_thread_ = guarded([this](std::stop_token stop) { master_->run(stop); });
    for (const auto& node : nodes_) {
        node_threads_.push_back(guarded([this, &node](std::stop_token stop) {
            const node::NodeResult result = node->run(stop);
            if (!result.failure.empty()) events_({wire::Severity::Error, "a node left: " + result.failure});
        }));
    }
}

EmbeddedCluster::~EmbeddedCluster() {
    is_stopping_ = true;
}

std::unique_ptr<net::Channel> EmbeddedCluster::client() {
    return net::make_zmq_client(context_, {.endpoint = Endpoint, .keys = {}});
}

void EmbeddedCluster::add_node(const EmbeddedSettings& settings, std::uint32_t index,
                               const std::shared_ptr<scene::BlobStore>& blobs, const Clock& clock) {
    const std::uint32_t threads = settings.threads != 0 ? settings.threads : core_count();
    auto backend = backend::find_backend(settings.backend)
                       .make({.threads = std::max(1u, threads / settings.nodes),
                              .isa = settings.isa,
                              .device = settings.device,
                              .cache_folder = settings.cache,
                              .blobs = blobs});
    node::NodeSettings node_settings{.name = "embedded-" + std::to_string(index + 1),
                                     .host = host_name(),
                                     .software = "tessera " + cli::version(),
                                     .pid = static_cast<std::uint64_t>(::getpid()),
                                     .backend = settings.backend,
                                     .reproducible = settings.isa == "avx2" || settings.backend == "null"};
    node_settings.liveness.missed = PatientHeartbeats;
    nodes_.push_back(std::make_unique<node::RenderNode>(
        net::make_zmq_client(context_, {.endpoint = Endpoint, .keys = {}}), std::move(backend), blobs, clock,
        node_settings,
        node::NodeCallbacks{.event =
                                [this](const node::Report& report) {
                                    events_({report.severity, report.text, report.about, report.is_detail});
                                },
                            .reconnect = {}}));
}

// Reports an exception that ends the thread; the master then notifies the client that no node is left.
template <class Function>
std::jthread EmbeddedCluster::guarded(Function function) {
    return std::jthread([this, function](std::stop_token stop) {
        try {
            function(stop);
        } catch (const std::exception& error) {
            events_({wire::Severity::Error, error.what()});
        }
    });
}

}  // namespace tessera::tools
