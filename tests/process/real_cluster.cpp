#include "tests/process/real_cluster.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include "tests/support/folders.h"

namespace tessera::test {

namespace {

constexpr std::chrono::minutes ClusterPatience(3);  // generous: the machine may be busy with other tests

nlohmann::json finished(ChildProcess process, const std::string& label) {
    const auto exit = process.wait(ClusterPatience);
    EXPECT_EQ(exit.value_or(-1), 0) << label << ": " << process.err();
    return nlohmann::json::parse(process.out(), nullptr, false);
}

}  // namespace

TemporaryFolder::TemporaryFolder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "tessera-test-XXXXXX").string();
    path_ = mkdtemp(pattern.data());
}

TemporaryFolder::~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
}

std::string scene_file(const std::string& name) {
    return (test::scenes_folder() / name).string();
}

RealCluster::RealCluster(std::vector<std::string> master_options, Session session)
    : endpoint_(free_loopback_endpoint()), master_options_(std::move(master_options)) {
    ChildProcess keys_tool(folder_.path(), "keys", "tessera", {"keys", keys()});
    EXPECT_EQ(keys_tool.wait(ClusterPatience).value_or(-1), 0) << keys_tool.err();
    if (session == Session::Kept) {
        master_options_.push_back("--session");
        master_options_.push_back(folder_ / "session");
    }
    start_master();
}

void RealCluster::kill_master() {
    master_->signal(SIGKILL);
    (void)master_->wait(ClusterPatience);
}

void RealCluster::start_master() {
    std::vector<std::string> arguments{"--listen", endpoint_, "--keys", keys()};
    arguments.insert(arguments.end(), master_options_.begin(), master_options_.end());
    master_.emplace(folder_.path(), "master" + std::to_string(++masters_), "tessera-master", arguments);
}

ChildProcess RealCluster::start_node(const std::string& name, std::vector<std::string> more) {
    std::vector<std::string> arguments{"--master", endpoint_, "--keys",    keys(),
                                       "--name",   name,      "--threads", "1"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return ChildProcess(folder_.path(), name, "tessera-node", arguments);
}

ChildProcess RealCluster::start_render(const std::string& label, const std::string& scene,
                                       std::vector<std::string> more) {
    std::vector<std::string> arguments{"render", scene,  "--master", endpoint_,
                                       "--keys", keys(), "-o",       folder_ / (label + ".exr")};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return ChildProcess(folder_.path(), label, "tessera", arguments);
}

nlohmann::json RealCluster::render(const std::string& label, const std::string& scene,
                                   std::vector<std::string> more) {
    more.push_back("--json");
    return finished(start_render(label, scene, std::move(more)), label);
}

nlohmann::json RealCluster::status() {
    const std::string label = "status" + std::to_string(next_status_++);
    return finished(ChildProcess(folder_.path(), label, "tessera",
                                 {"status", "--master", endpoint_, "--keys", keys(), "--json"}),
                    label);
}

nlohmann::json render_embedded(const TemporaryFolder& folder, const std::string& label,
                               const std::string& scene, std::vector<std::string> more) {
    std::vector<std::string> arguments{"render", scene, "-o", folder / (label + ".exr"), "--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return finished(ChildProcess(folder.path(), label, "tessera", arguments), label);
}

}  // namespace tessera::test
