#include <algorithm>
#include <exception>
#include <iostream>
#include <vector>

#include "client/tools/bench.h"
#include "client/tools/compare.h"
#include "client/tools/display/display_command.h"
#include "client/tools/doctor.h"
#include "client/tools/edit.h"
#include "client/tools/filter_tool.h"
#include "client/tools/info.h"
#include "client/tools/jobs.h"
#include "client/tools/keys_tool.h"
#include "client/tools/live_target.h"
#include "client/tools/log_tool.h"
#include "client/tools/node_tool.h"
#include "client/tools/probe.h"
#include "client/tools/render.h"
#include "client/tools/set_filter.h"
#include "client/tools/status.h"
#include "client/tools/watch.h"
#include "mediator/program/command_line.h"

int main(int argc, char** argv) {
    using namespace tessera;
    if (tools::names_bench(argc, argv)) return tools::start_bench(argv);
    cli::CommandLine line(
        "tessera", "Tessera, a distributed path tracer: one master owns scene and picture, nodes render.");
    const std::vector<tools::Command> commands{tools::info_command(line),
                                               tools::render_command(line),
                                               tools::jobs_command(line),
                                               tools::fetch_command(line),
                                               tools::edit_command(line, tools::connect_scene),
                                               tools::watch_command(line),
                                               tools::log_command(line),
                                               tools::status_command(line),
                                               tools::node_command(line),
                                               tools::probe_command(line),
                                               tools::keys_command(line),
                                               tools::compare_command(line),
                                               tools::filter_command(line),
                                               tools::filters_command(line),
                                               tools::set_filter_command(line),
                                               tools::bench_command(line),
                                               tools::display_command(line),
                                               tools::doctor_command(line),
                                               tools::coverage_command(line)};
    line.examples(
        {"tessera render room.glb -o room.exr -o room.png", "tessera doctor", "tessera render --help"});
    if (const auto exit = line.parse(argc, argv, std::cout, std::cerr)) return *exit;

    const std::string chosen = line.chosen();
    const std::string first = chosen.substr(0, chosen.find(' '));
    const auto command = std::find_if(commands.begin(), commands.end(), [&](const tools::Command& candidate) {
        return candidate.name == first;
    });
    try {
        return command->run(chosen);
    } catch (const std::exception& error) {
        return tools::report_error(first, tools::ExitInternal, error.what());
    }
}
