#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "client/session.h"
#include "client/tools/child_process.h"

namespace tessera::tools::bench {

enum class Encryption { Curve, None };

// A master and nodes as separate processes, with keys generated for the bench. The destructor ends them.
class LiveCluster {
  public:
    // Throws Error when a program is missing or does not start.
    LiveCluster(std::uint32_t nodes, const std::string& backend, Encryption encryption = Encryption::Curve);
    ~LiveCluster();

    std::unique_ptr<client::Session> join(const std::string& name, std::shared_ptr<scene::BlobStore> blobs,
                                          const Clock& clock) const;
    session::ClusterStatus status(const Clock& clock) const;
    std::uint64_t master_memory() const;       // bytes in RAM
    std::uint64_t master_peak_memory() const;  // peak so far
    pid_t master_pid() const { return master_->pid(); }
    std::vector<pid_t> node_pids() const;

    const std::string& endpoint() const { return endpoint_; }
    std::filesystem::path keys() const { return folder_ / "keys"; }
    const std::filesystem::path& folder() const { return folder_; }

  private:
    client::SessionSettings settings(const std::string& name) const;
    client::Address address() const;

    std::filesystem::path folder_;
    std::string endpoint_;
    Encryption encryption_;
    std::optional<ChildProcess> master_;
    std::vector<ChildProcess> nodes_;
};

}  // namespace tessera::tools::bench
