#include "client/tools/display/check_command.h"

#include <iostream>
#include <memory>
#include <string>

#include "client/display_file/display_file.h"
#include "client/tools/display/display_table.h"

namespace tessera::tools {

namespace {

constexpr const char* Name = "display check";

int run(const std::string& path) {
    scene::BlobStore blobs;
    const display_file::DisplayFile file = display_file::read_display(path, blobs);
    std::cout << as_table(file.display);
    return 0;
}

}  // namespace

Command check_display_command(cli::CommandLine& display) {
    const auto path = std::make_shared<std::string>();
    cli::CommandLine& line =
        display.command("check", "Read a display file, say what is wrong with it, and what it needs.");
    line.positional("FILE", "the display, as TOML: docs/displays.md", *path);
    line.examples({"tessera display check wall.toml"});
    return {Name, [path](std::string_view) {
                try {
                    return run(*path);
                } catch (const Error& error) {
                    return complain(Name, exit_code(error.code()), error.what());
                }
            }};
}

}  // namespace tessera::tools
