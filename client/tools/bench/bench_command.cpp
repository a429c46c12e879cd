#include "client/tools/bench/bench_command.h"

#include <algorithm>
#include <vector>

#include "client/tools/bench/backends_command.h"
#include "client/tools/bench/displays_command.h"
#include "client/tools/bench/filters_command.h"
#include "client/tools/bench/live_command.h"
#include "client/tools/bench/pictures.h"

namespace tessera::tools {

Command bench_command(cli::CommandLine& program) {
    cli::CommandLine& line = program.command(
        "bench", "Measure speed against error, back-ends beside each other, edits and displays.");
    const std::vector<Command> commands{bench::backends_command(line), bench::displays_command(line),
                                        bench::filters_command(line), bench::live_command(line),
                                        bench::pictures_command(line)};
    return {"bench", [commands](std::string_view chosen) {
                const auto command = std::ranges::find(commands, chosen, &Command::name);
                return command->run(chosen);
            }};
}

}  // namespace tessera::tools
