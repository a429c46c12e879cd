#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "tests/process/child_process.h"

namespace tessera::test {

// A temporary folder, removed after the test.
class TemporaryFolder {
  public:
    TemporaryFolder();
    ~TemporaryFolder();
    const std::filesystem::path& path() const { return path_; }
    std::string operator/(const std::string& name) const { return (path_ / name).string(); }

  private:
    std::filesystem::path path_;
};

// A master and nodes as separate processes: TCP on loopback, with CURVE keys created for the test.
class RealCluster {
  public:
    RealCluster() : RealCluster({"--heartbeat", "0.25"}, Session::None) {}
    enum class Session { None, Kept };  // on disk
    RealCluster(std::vector<std::string> master_options, Session session);

    void kill_master();   // without a word
    void start_master();  // again, at the same place

    ChildProcess start_node(const std::string& name, std::vector<std::string> more = {});
    // `tessera render` on this cluster; the picture is written to the folder.
    ChildProcess start_render(const std::string& label, const std::string& scene,
                              std::vector<std::string> more);
    // Runs it to the end and parses --json; a failure fails the test.
    nlohmann::json render(const std::string& label, const std::string& scene, std::vector<std::string> more);
    nlohmann::json status();
    // Polls the status until `done` returns true; false after the limit.
    template <class Done>
    bool wait_for(const Done& done, std::chrono::seconds limit = std::chrono::seconds(60)) {
        const auto deadline = std::chrono::steady_clock::now() + limit;
        while (std::chrono::steady_clock::now() < deadline) {
            if (done(status())) return true;
        }
        return false;
    }

    const std::string& endpoint() const { return endpoint_; }
    std::string keys() const { return folder_ / "keys"; }
    const TemporaryFolder& folder() const { return folder_; }
    ChildProcess& master() { return *master_; }

  private:
    TemporaryFolder folder_;
    std::string endpoint_;
    std::vector<std::string> master_options_;
    std::optional<ChildProcess> master_;
    int masters_ = 0;
    int next_status_ = 0;
};

// The embedded cluster: everything in one process.
nlohmann::json render_embedded(const TemporaryFolder& folder, const std::string& label,
                               const std::string& scene, std::vector<std::string> more);

std::string scene_file(const std::string& name);

}  // namespace tessera::test
