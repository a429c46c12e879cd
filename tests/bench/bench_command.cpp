#include "tests/bench/bench_command.h"

#include <algorithm>
#include <vector>

#include "tests/bench/adaptive/adaptive_command.h"
#include "tests/bench/backends/backends_command.h"
#include "tests/bench/consistency/consistency_command.h"
#include "tests/bench/filters/filters_command.h"
#include "tests/bench/filters/pictures.h"
#include "tests/bench/live/displays_command.h"
#include "tests/bench/live/live_command.h"
#include "tests/bench/transport/transport_command.h"
#include "tests/bench/variance/variance_command.h"

namespace tessera::tools::bench {

Command bench_command(cli::CommandLine& program) {
    cli::CommandLine& line =
        program.command("bench",
                        "Benchmarks: adaptive sampling, error, time and consistency of denoisers, accuracy "
                        "of variances, light transport, back-ends, edits and displays.");
    const std::vector<Command> commands{
        adaptive_command(line), backends_command(line),  consistency_command(line),
        displays_command(line), filters_command(line),   live_command(line),
        pictures_command(line), transport_command(line), variance_command(line)};
    return {"bench", [commands](std::string_view chosen) {
                const auto command = std::ranges::find(commands, chosen, &Command::name);
                try {
                    return command->run(chosen);
                } catch (const Error& error) {
                    return report_error(command->name, exit_code(error.code()), error.what());
                }
            }};
}

}  // namespace tessera::tools::bench
