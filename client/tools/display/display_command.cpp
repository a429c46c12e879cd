#include "client/tools/display/display_command.h"

#include <algorithm>
#include <vector>

#include "client/tools/display/adjust_command.h"
#include "client/tools/display/check_command.h"
#include "client/tools/display/close_command.h"
#include "client/tools/display/import_command.h"
#include "client/tools/display/open_command.h"
#include "client/tools/display/pattern_command.h"
#include "client/tools/display/track_command.h"
#include "client/tools/display/viewer_preview_command.h"

namespace tessera::tools {

Command display_command(cli::CommandLine& program) {
    cli::CommandLine& line = program.command("display", "Check and run displays: screens and outputs.");
    const std::vector<Command> commands{check_display_command(line),  pattern_command(line),
                                        viewer_preview_command(line), open_display_command(line),
                                        adjust_display_command(line), track_command(line),
                                        close_display_command(line),  import_command(line)};
    return {"display", [commands](std::string_view chosen) {
                const auto command = std::ranges::find(commands, chosen, &Command::name);
                return command->run(chosen);
            }};
}

}  // namespace tessera::tools
