#include "client/tools/bench/live_cluster.h"

#include <stdlib.h>
#include <unistd.h>

#include <fstream>

namespace tessera::tools::bench {

namespace {

std::filesystem::path temporary_folder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "tessera-bench-XXXXXX").string();
    if (mkdtemp(pattern.data()) == nullptr)
        throw Error(ErrorCode::Io, "cannot make a folder in " +
                                       std::filesystem::temp_directory_path().string() + ": is it writable?");
    return pattern;
}

}  // namespace

LiveCluster::LiveCluster(std::uint32_t nodes, const std::string& backend)
    : folder_(temporary_folder()), endpoint_(free_loopback_endpoint()) {
    const std::filesystem::path bin = program_folder();
    ChildProcess keys_tool(folder_, "keys", bin / "tessera", {"keys", keys().string()});
    if (keys_tool.wait(std::chrono::seconds(30)) != 0)
        throw Error(ErrorCode::Internal, "cannot make keys: " + keys_tool.err());
    master_.emplace(folder_, "master", bin / "tessera-master",
                    std::vector<std::string>{"--listen", endpoint_, "--keys", keys().string()});
    for (std::uint32_t i = 1; i <= nodes; ++i) {
        const std::string name = "node-" + std::to_string(i);
        nodes_.emplace_back(folder_, name, bin / "tessera-node",
                            std::vector<std::string>{"--master", endpoint_, "--keys", keys().string(),
                                                     "--name", name, "--threads", "1", "--backend", backend});
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

std::unique_ptr<client::LiveSession> LiveCluster::join(const std::string& name,
                                                       std::shared_ptr<scene::BlobStore> blobs,
                                                       const Clock& clock) const {
    auto session = client::connect_live({.endpoint = endpoint_, .keys = keys().string()}, std::move(blobs),
                                        clock, settings(name));
    session->join("bench", client::WhenBusy::GiveUp, nullptr, {});
    return session;
}

client::ClusterStatus LiveCluster::status(const Clock& clock) const {
    return client::connect({.endpoint = endpoint_, .keys = keys().string()},
                           std::make_shared<scene::BlobStore>(), clock, settings("status"))
        ->status();
}

std::uint64_t LiveCluster::master_memory() const {
    std::ifstream file("/proc/" + std::to_string(master_->pid()) + "/statm");
    std::uint64_t total = 0, resident = 0;
    file >> total >> resident;
    return resident * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
}

}  // namespace tessera::tools::bench
