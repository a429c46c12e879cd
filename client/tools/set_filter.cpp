#include "client/tools/set_filter.h"

#include <iostream>
#include <memory>

#include "client/session.h"
#include "client/tools/cluster_options.h"

namespace tessera::tools {

namespace {

constexpr const char* SetFilterName = "set-filter";

struct SetFilterOptions {
    client::Address address;
    std::string filter, view;
};

int run(const SetFilterOptions& options) {
    try {
        const SteadyClock clock;
        const auto session = client::connect(options.address, std::make_shared<scene::BlobStore>(), clock,
                                             session_settings("tessera set-filter"));
        std::cout << session->set_filter(options.view, options.filter) << std::endl;
        return 0;
    } catch (const Error& error) {
        return report_error(SetFilterName, exit_code(error.code()), error.what());
    }
}

}  // namespace

Command set_filter_command(cli::CommandLine& program) {
    const auto options = std::make_shared<SetFilterOptions>();
    cli::CommandLine& line = program.command(
        SetFilterName, "Change the filter, or its parameters, of a view that a cluster is rendering.");
    line.positional("FILTER", "NAME[:key=value,...]; tessera filters lists them", options->filter);
    line.option("--view", "name of the view of a live scene; tessera edit -c members lists them",
                options->view);
    add_cluster_options(line, options->address);
    line.required("--master");
    line.examples({"tessera set-filter fdf --master tcp://render-1:7420 --keys ~/.tessera",
                   "tessera set-filter pixel:t=0.002 --view ann/1 --master tcp://127.0.0.1:7420"});
    return {SetFilterName, [options](std::string_view) { return run(*options); }};
}

}  // namespace tessera::tools
