#include "client/tools/node_tool.h"

#include <iostream>
#include <memory>

#include "client/session.h"
#include "client/tools/cluster_options.h"

namespace tessera::tools {

namespace {

struct NodeOrder {
    client::Address address{.endpoint = "tcp://127.0.0.1:7420", .user = "operator"};
    std::string name;
};

int run(const NodeOrder& order, std::string_view chosen) {
    try {
        const SteadyClock clock;
        const auto session = client::connect(order.address, std::make_shared<scene::BlobStore>(), clock,
                                             session_settings("tessera node"));
        if (chosen == "node release") {
            session->release_node(order.name);
            std::cout << "node " << order.name << " gets work again" << std::endl;
        } else {
            session->drain_node(order.name);
            std::cout << "node " << order.name << " leaves after the units that it is rendering" << std::endl;
        }
        return 0;
    } catch (const Error& error) {
        return report_error("node", exit_code(error.code()), error.what());
    }
}

void add_order(cli::CommandLine& line, NodeOrder& order) {
    line.positional("NAME", "name of the node; tessera status lists them", order.name);
    add_cluster_options(line, order.address);
}

}  // namespace

Command node_command(cli::CommandLine& program) {
    const auto order = std::make_shared<NodeOrder>();
    cli::CommandLine& line =
        program.command("node", "Manage the nodes of a cluster, with an operator's key.");
    cli::CommandLine& release = line.command(
        "release", "End the quarantine of a node that failed, or sent film that it was not asked for.");
    add_order(release, *order);
    release.examples({"tessera node release render-7 --master tcp://render-1:7420 --keys ~/.tessera"});
    cli::CommandLine& drain =
        line.command("drain", "Make a node finish what it renders, and leave the cluster.");
    add_order(drain, *order);
    drain.examples({"tessera node drain render-7 --master tcp://render-1:7420 --keys ~/.tessera"});
    return {"node", [order](std::string_view chosen) { return run(*order, chosen); }};
}

}  // namespace tessera::tools
