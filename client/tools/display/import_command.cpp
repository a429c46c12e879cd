#include "client/tools/display/import_command.h"

#include <filesystem>
#include <iostream>
#include <memory>
#include <string_view>

#include "client/display_file/mpcdi_import.h"
#include "mediator/picture/atomic_file.h"

namespace tessera::tools {

namespace {

constexpr const char* ImportName = "display import";

int run(const std::string& archive, const std::string& output) {
    const auto mpcdi = display_file::load_mpcdi(archive);
    if (!mpcdi) throw mpcdi.error();
    const std::filesystem::path path(output);
    const display_file::ImportedDisplay imported = display_file::import_mpcdi(*mpcdi, path.stem().string());
    for (const auto& file : imported.files)
        picture::write_atomically((path.parent_path() / file.name).string(),
                                  {reinterpret_cast<const char*>(file.content.data()), file.content.size()});
    picture::write_atomically(output, imported.text);
    std::cout << "wrote " << output << " and " << imported.files.size() << " files in its folder\n";
    for (const std::string& notice : imported.notices) std::cout << "note: " << notice << "\n";
    return 0;
}

}  // namespace

Command import_command(cli::CommandLine& display) {
    struct Options {
        std::string archive, output;
    };
    const auto options = std::make_shared<Options>();
    cli::CommandLine& line = display.command(
        "import",
        "Convert an archive in VESA's MPCDI format to a display file and its calibration files: "
        "profiles 2d, 3d, a3, and sl without lens distortion.");
    line.positional("FILE", "the archive", options->archive);
    line.option("-o,--output", "display file to write; its calibration files go to the same folder",
                options->output);
    line.required("--output");
    line.examples({"tessera display import wall.mpcdi -o wall.toml"});
    return {ImportName, [options](std::string_view) {
                try {
                    return run(options->archive, options->output);
                } catch (const Error& error) {
                    return report_error(ImportName, exit_code(error.code()), error.what());
                }
            }};
}

}  // namespace tessera::tools
