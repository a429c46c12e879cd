#include "client/tools/display/open_command.h"

#include <algorithm>
#include <cctype>
#include <iostream>
#include <memory>
#include <string>

#include "client/display_file/display_file.h"
#include "client/session.h"
#include "client/tools/cluster_options.h"
#include "client/tools/interrupts.h"
#include "mediator/view/placed_cameras.h"

namespace tessera::tools {

namespace {

constexpr const char* OpenName = "display open";

struct OpenOptions {
    std::string file, title = "scene";
    client::Address address;
    bool no_wait = false;
};

// Quoted as one word of a shell.
std::string shell_quoted(const std::string& word) {
    const auto is_plain = [](unsigned char c) {
        return std::isalnum(c) != 0 ||
               std::string_view("-_./:~@%+=,").find(char(c)) != std::string_view::npos;
    };
    if (!word.empty() && std::ranges::all_of(word, is_plain)) return word;
    std::string text = "'";
    for (const char c : word) text += c == '\'' ? "'\\''" : std::string(1, c);
    return text + "'";
}

// The commands that start its outputs on this cluster.
std::string start_lines(const display::Display& display, const client::Address& address) {
    std::string text;
    for (const display::Output& output : display.outputs) {
        text += "  tessera-display --master " + address.endpoint;
        if (!address.keys.empty()) text += " --keys " + shell_quoted(address.keys);
        text += " --output " + output.name + "\n";
    }
    return text;
}

int run(const OpenOptions& options) {
    Interrupts interrupts;  // before starting any thread
    const SteadyClock clock;
    const auto blobs = std::make_shared<scene::BlobStore>();
    const display_file::DisplayFile file = display_file::read_display(options.file, *blobs);
    const display::Display& display = file.display;
    const auto session = client::connect(options.address, blobs, clock,
                                         session_settings("display " + display.name, interrupts.token()));
    const auto joined =
        session->join({.title = options.title,
                       .when_busy = options.no_wait ? client::WhenBusy::GiveUp : client::WhenBusy::Queue,
                       .on_place =
                           [](std::uint32_t place) {
                               std::cerr << "tessera display open: the cluster is busy: place " << place
                                         << " in the queue\n";
                           }},
                      interrupts.token());
    if (std::holds_alternative<client::Stopped>(joined)) return ExitInterrupted;
    if (const auto* busy = std::get_if<client::Busy>(&joined))
        return report_error(OpenName, cli::ExitTryLater, busy->reason);
    session->open_display(display);
    std::cout << "display '" << display.name << "' is open on the live scene '"
              << std::get<client::Joined>(joined).title
              << "'. Start its outputs, each on the machine of its screen:\n"
              << start_lines(display, options.address) << std::flush;
    if (const auto camera = view::choose_camera(session->scene(), display.camera); !camera)
        std::cerr << "tessera display open: warning: nothing is shown yet: " << camera.error().what() << "\n";
    return 0;
}

}  // namespace

Command open_display_command(cli::CommandLine& display) {
    const auto options = std::make_shared<OpenOptions>();
    cli::CommandLine& line = display.command(
        "open",
        "Open a display on the live scene, replacing the previous one, and print the commands that start its "
        "outputs. It stays open until it or the scene is closed.");
    line.positional("FILE", "the display, as TOML: docs/displays.md", options->file);
    add_cluster_options(line, options->address);
    line.required("--master");
    line.option("--scene", "title of the live scene, if this starts it", options->title);
    line.flag("--no-wait", "exit with 75 if a batch job has the cluster, instead of waiting",
              options->no_wait);
    line.examples({"tessera display open wall.toml --master tcp://render-1:7420 --keys ~/.tessera"});
    return {OpenName, [options](std::string_view) {
                try {
                    return run(*options);
                } catch (const Error& error) {
                    return report_error(OpenName, exit_code(error.code()), error.what());
                }
            }};
}

}  // namespace tessera::tools
