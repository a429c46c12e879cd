#include <unistd.h>

#include <functional>
#include <iostream>
#include <memory>
#include <string>
#include <thread>
#include <utility>

#include "client/display/output_player.h"
#include "client/display/picture_files.h"
#include "client/display/shared_memory.h"
#include "client/display/window.h"
#include "client/session.h"
#include "client/tools/command.h"
#include "client/tools/interrupts.h"
#include "client/tools/this_machine.h"
#include "mediator/base/freed_memory.h"
#include "mediator/program/command_line.h"

namespace {

using namespace tessera;

struct Options {
    client::Address address{.endpoint = "tcp://127.0.0.1:7420", .user = "viewer"};
    std::string output, log, png, shm;
    bool headless = false, window = false;
    std::uint64_t frames = 0;
};

// Shows nothing anywhere: to measure, or to see that the lock works.
class Nowhere final : public client_display::Presenter {
  public:
    void prepare(client_display::DevicePictures) override {}
    void present(std::uint64_t) override {}
};

client_display::MakePresenter presenter(const Options& options) {
    if (!options.png.empty())
        return [&](const display::Output& output) {
            return client_display::make_picture_files(options.png, output);
        };
    if (!options.shm.empty())
        return [&](const display::Output& output) {
            return client_display::make_shared_memory(options.shm, output);
        };
    if (options.headless) return [](const display::Output&) { return std::make_unique<Nowhere>(); };
    return client_display::make_windows(options.window ? client_display::WindowMode::Framed
                                                       : client_display::WindowMode::FullScreen);
}

client::SessionSettings session_settings(const Options& options) {
    return {.name = "output " + options.output,
            .host = tools::host_name(),
            .software = "tessera-display " + cli::version(),
            .pid = static_cast<std::uint64_t>(::getpid()),
            .connect_limit = std::chrono::seconds(3),  // a stop waits so long
            .lost_limit = std::chrono::hours(24 * 365),
            .mirrors_scene = false};
}

// Waits for a master that is not there yet; null when stopped before.
std::unique_ptr<client::Session> connected(const Options& options, std::shared_ptr<scene::BlobStore> blobs,
                                           const Clock& clock,
                                           const std::function<void(const std::string&)>& tell,
                                           std::stop_token stop) {
    const client::SessionSettings settings = session_settings(options);
    for (bool told = false; !stop.stop_requested(); told = true) {
        try {
            return client::connect(options.address, blobs, clock, settings);
        } catch (const Error& error) {
            if (error.code() != ErrorCode::Unavailable) throw;
            if (!told) tell(std::string(error.what()) + " Waiting");
        }
    }
    return nullptr;
}

// A scene that was closed is opened again by who has something to show, not by its outputs: they only look.
// False when stopped before.
bool await_scene(const Options& options, const std::shared_ptr<scene::BlobStore>& blobs, const Clock& clock,
                 const std::function<void(const std::string&)>& tell, std::stop_token stop) {
    for (bool told = false; !stop.stop_requested();) {
        std::this_thread::sleep_for(std::chrono::milliseconds(500));
        try {
            const auto session = client::connect(options.address, blobs, clock, session_settings(options));
            const session::SceneStatus scene = session->status().scene;
            if (!scene.title.empty() && !scene.exclusive) return true;
            if (!std::exchange(told, true)) tell("the live scene was closed; waiting for the next one");
        } catch (const Error& error) {
            if (error.code() != ErrorCode::Unavailable) throw;
        }
    }
    return false;
}

int show(const Options& options) {
    const tools::Interrupts interrupts;  // before anything that starts threads
    const SteadyClock clock;
    const auto blobs = std::make_shared<scene::BlobStore>();
    client_display::FrameLog log;
    if (!options.log.empty()) log = client_display::FrameLog(options.log);
    const auto tell = [&](const std::string& text) { std::cerr << "tessera-display: " << text << std::endl; };
    const client_display::MakePresenter make_presenter = presenter(options);
    const auto session = connected(options, blobs, clock, tell, interrupts.token());
    if (!session) return tools::ExitInterrupted;
    const auto join = [&] {
        const auto joined =
            session->join({.on_place = [&](std::uint32_t) { tell("a batch has the cluster: waiting"); }},
                          interrupts.token());
        return !std::holds_alternative<client::Stopped>(joined);
    };
    if (!join()) return tools::ExitInterrupted;
    client_display::OutputPlayer player(*session, *blobs, clock, options.output, make_presenter, log, tell);
    for (bool is_member = true;;) {
        try {
            if (!is_member && !(await_scene(options, blobs, clock, tell, interrupts.token()) && join()))
                return tools::ExitInterrupted;
            player.run(options.frames, interrupts.token());
            return 0;
        } catch (const Error& error) {
            // What the scene's end cut short is refused, one by one.
            if (error.code() != ErrorCode::Refused || interrupts.token().stop_requested()) throw;
            is_member = false;
        }
    }
}

}  // namespace

int main(int argc, char** argv) {
    keep_freed_memory();
    Options options;
    cli::CommandLine line(
        "tessera-display",
        "Shows one output of the display in front of a live scene, in step with all others.");
    line.option("--master", "where the cluster is: tcp://host:port", options.address.endpoint);
    line.option("--keys", "keys for that cluster: a folder, or an exported file; none: not encrypted",
                options.address.keys);
    line.option("--user", "whose pair in a folder of keys; a viewer's will do", options.address.user);
    line.option("--output", "which output of the display file this process shows", options.output);
    line.flag("--window", "in a window of the output's size, instead of the full screen", options.window);
    line.flag("--headless", "without a window; for what it shows, see --png and --shm", options.headless);
    line.option("--png", "headless: keep FOLDER/OUTPUT.png at what is shown now", options.png);
    line.option("--shm", "headless: show in POSIX shared memory of this name, as /left", options.shm);
    line.option("--log", "append what was shown when to this file, a JSON object a line", options.log);
    line.option("--frames", "end after so many frames; 0 = never", options.frames);
    line.required("--output");
    line.examples({"tessera-display --master tcp://wall-master:7420 --keys ~/.tessera --output left",
                   "tessera-display --output left --headless --png shown --log left.log",
                   "tessera-display --output left --window"});
    if (const auto exit = line.parse(argc, argv, std::cout, std::cerr)) return *exit;
    const auto usage = [](const std::string& text) {
        std::cerr << "tessera-display: " << text << "\n";
        return cli::ExitUsage;
    };
    if (options.window && options.headless) return usage("--window and --headless exclude each other");
    if ((!options.png.empty() || !options.shm.empty()) && !options.headless)
        return usage("--png and --shm go with --headless");
    if (!options.png.empty() && !options.shm.empty()) return usage("--png and --shm exclude each other");
    if (!options.shm.empty() &&
        (!options.shm.starts_with('/') || options.shm.find('/', 1) != std::string::npos))
        return usage("--shm: a name has a slash in front and no other, like /left");
    try {
        return show(options);
    } catch (const Error& error) {
        std::cerr << "tessera-display: " << error.what() << "\n";
        return tools::exit_code(error.code());
    }
}
