#include "client/tools/display/close_command.h"

#include <iostream>
#include <memory>

#include "client/tools/cluster_options.h"
#include "client/tools/display/live_display.h"

namespace tessera::tools {

namespace {

constexpr const char* CloseName = "display close";

int run(const client::Address& address) {
    const SteadyClock clock;
    const DisplayMember member = join_display(address, "tessera display close", clock);
    member.session->close_display();
    std::cout << "display '" << member.display << "' is closed\n";
    return 0;
}

}  // namespace

Command close_display_command(cli::CommandLine& display) {
    const auto address = std::make_shared<client::Address>();
    cli::CommandLine& line = display.command(
        "close", "Close the display of the live scene. Its output processes wait for the next one.");
    add_cluster_options(line, *address);
    line.required("--master");
    line.examples({"tessera display close --master tcp://render-1:7420 --keys ~/.tessera"});
    return {CloseName, [address](std::string_view) {
                try {
                    return run(*address);
                } catch (const Error& error) {
                    return report_error(CloseName, exit_code(error.code()), error.what());
                }
            }};
}

}  // namespace tessera::tools
