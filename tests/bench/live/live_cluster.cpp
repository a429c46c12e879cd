#include "tests/bench/live/live_cluster.h"

#include <stdlib.h>
#include <unistd.h>

#include <fstream>

namespace tessera::tools::bench {

namespace {

std::filesystem::path temporary_folder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "tessera-bench-XXXXXX").string();
    if (mkdtemp(pattern.data()) == nullptr)
        throw Error(ErrorCode::Io, "cannot create a folder in " +
                                       std::filesystem::temp_directory_path().string() + ": is it writable?");
    return pattern;
}

}  // namespace

LiveCluster::LiveCluster(std::uint32_t nodes, const std::string& backend, Encryption encryption)
    : folder_(temporary_folder()), endpoint_(free_loopback_endpoint()), encryption_(encryption) {
    const std::filesystem::path bin = program_folder();
    ChildProcess keys_tool(folder_, "keys", bin / "tessera", {"keys", keys().string()});
    if (keys_tool.wait(std::chrono::seconds(30)) != 0)
        throw Error(ErrorCode::Internal, "cannot generate keys: " + keys_tool.err());
    const std::vector<std::string> security = encryption == Encryption::Curve
                                                  ? std::vector<std::string>{"--keys", keys().string()}
                                                  : std::vector<std::string>{"--insecure"};
    const auto with_security = [&](std::vector<std::string> arguments) {
        arguments.insert(arguments.end(), security.begin(), security.end());
        return arguments;
    };
    master_.emplace(folder_, "master", bin / "tessera-master", with_security({"--listen", endpoint_}));
    for (std::uint32_t i = 1; i <= nodes; ++i) {
        const std::string name = "node-" + std::to_string(i);
        nodes_.emplace_back(
            folder_, name, bin / "tessera-node",
            with_security({"--master", endpoint_, "--name", name, "--threads", "1", "--backend", backend}));
    }
}

LiveCluster::~LiveCluster() {
    nodes_.clear();
    master_.reset();
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
}

client::SessionSettings LiveCluster::settings(const std::string& name) const {
    return {.name = name, .connect_limit = std::chrono::seconds(30)};
}

std::unique_ptr<client::Session> LiveCluster::join(const std::string& name,
                                                   std::shared_ptr<scene::BlobStore> blobs,
                                                   const Clock& clock) const {
    auto session = client::connect(address(), std::move(blobs), clock, settings(name));
    session->join({.title = "bench", .when_busy = client::WhenBusy::GiveUp}, {});
    return session;
}

session::ClusterStatus LiveCluster::status(const Clock& clock) const {
    return client::connect(address(), std::make_shared<scene::BlobStore>(), clock, settings("status"))
        ->status();
}

client::Address LiveCluster::address() const {
    client::Address address{.endpoint = endpoint_};
    if (encryption_ == Encryption::Curve) address.keys = keys().string();
    return address;
}

std::vector<pid_t> LiveCluster::node_pids() const {
    std::vector<pid_t> pids;
    for (const ChildProcess& node : nodes_) pids.push_back(node.pid());
    return pids;
}

std::uint64_t LiveCluster::master_peak_memory() const {
    std::ifstream file("/proc/" + std::to_string(master_->pid()) + "/status");
    for (std::string word; file >> word;) {
        std::uint64_t kibibytes = 0;
        if (word == "VmHWM:" && file >> kibibytes) return kibibytes << 10;
    }
    return 0;
}

std::uint64_t LiveCluster::master_memory() const {
    std::ifstream file("/proc/" + std::to_string(master_->pid()) + "/statm");
    std::uint64_t total = 0, resident = 0;
    file >> total >> resident;
    return resident * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
}

}  // namespace tessera::tools::bench
