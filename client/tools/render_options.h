#pragma once

#include <optional>
#include <string>
#include <vector>

#include "client/cli/log.h"
#include "client/job.h"
#include "client/session.h"
#include "client/tools/embedded_cluster.h"
#include "client/tools/view_options.h"
#include "mediator/picture/film_exr.h"

namespace tessera::tools {

// The options of `tessera render`, as typed.
struct RenderOptions {
    ViewOptions view;
    std::vector<std::string> outputs;
    std::optional<std::uint64_t> spp, nodes, threads;
    std::optional<std::string> time, backend, device, cache, master, keys, wait_nodes;
    std::string user = "editor";
    std::string policy = "mixed";
    std::string filter;
    bool reproducible = false, no_wait = false, json = false, save_statistics = false;
    cli::LogSettings log{.program = "tessera"};

    void add_to(cli::CommandLine& command);
};

// The same, understood.
struct RenderPlan {
    ViewPlan view;
    client::JobRequest job;  // view with channels, without camera
    std::vector<std::string> outputs;
    std::optional<client::Address> address;  // none: embedded
    EmbeddedSettings embedded;
    client::WhenBusy when_busy = client::WhenBusy::Queue;
    picture::Statistics statistics = picture::Statistics::Left;
};
Expected<RenderPlan> understand(const RenderOptions& options);

}  // namespace tessera::tools
