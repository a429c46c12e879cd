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
#include "client/tools/host_info.h"
#include "client/tools/interrupts.h"
#include "mediator/base/malloc_trim.h"
#include "mediator/program/command_line.h"

namespace {

using namespace tessera;

struct Options {
    client::Address address{.endpoint = "tcp://127.0.0.1:7420", .user = "viewer"};
    std::string output, log, png, shm;
    bool headless = false, window = false;
    std::uint64_t frames = 0;
};

// Presents nothing: for measurements and tests of the frame lock.
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

client::SessionSettings session_settings(const Options& options, std::stop_token stop) {
    return {.name = "output " + options.output,
            .host = tools::host_name(),
            .software = "tessera-display " + cli::version(),
            .pid = static_cast<std::uint64_t>(::getpid()),
            .connect_limit = std::chrono::seconds(3),
            .lost_limit = std::chrono::hours(24 * 365),
            .stop = std::move(stop),
            .mirrors_scene = false};
}

// Waits until a master is available; null when stopped before.
std::unique_ptr<client::Session> connected(const Options& options, std::shared_ptr<scene::BlobStore> blobs,
                                           const Clock& clock,
                                           const std::function<void(const std::string&)>& report,
                                           std::stop_token stop) {
    const client::SessionSettings settings = session_settings(options, stop);
    for (bool notified = false; !stop.stop_requested(); notified = true) {
        try {
            return client::connect(options.address, blobs, clock, settings);
        } catch (const Error& error) {
            if (error.code() != ErrorCode::Unavailable) throw;
            if (!notified && !stop.stop_requested()) report(std::string(error.what()) + " Waiting");
        }
    }
    return nullptr;
}

// Output processes do not open scenes: waits until another client opens the live scene. False when stopped before.
bool await_scene(const Options& options, const std::shared_ptr<scene::BlobStore>& blobs, const Clock& clock,
                 const std::function<void(const std::string&)>& report, std::stop_token stop) {
    for (bool notified = false; !stop.stop_requested();) {
        std::this_thread::sleep_for(std::chrono::milliseconds(500));
        try {
            const auto session =
                client::connect(options.address, blobs, clock, session_settings(options, stop));
            const session::SceneStatus scene = session->status().scene;
            if (!scene.title.empty() && !scene.exclusive) return true;
            if (!std::exchange(notified, true)) report("the live scene was closed; waiting for the next one");
        } catch (const Error& error) {
            if (error.code() != ErrorCode::Unavailable) throw;
        }
    }
    return false;
}

int show(const Options& options) {
    const tools::Interrupts interrupts;  // before starting any thread
    const SteadyClock clock;
    const auto blobs = std::make_shared<scene::BlobStore>();
    client_display::FrameLog log;
    if (!options.log.empty()) log = client_display::FrameLog(options.log);
    const auto report = [&](const std::string& text) {
        std::cerr << "tessera-display: " << text << std::endl;
    };
    const client_display::MakePresenter make_presenter = presenter(options);
    const auto session = connected(options, blobs, clock, report, interrupts.token());
    if (!session) return tools::ExitInterrupted;
    const auto join = [&] {
        const auto joined = session->join(
            {.on_place = [&](std::uint32_t) { report("a batch job has the cluster: waiting"); }},
            interrupts.token());
        return !std::holds_alternative<client::Stopped>(joined);
    };
    if (!join()) return tools::ExitInterrupted;
    client_display::OutputPlayer player(*session, *blobs, clock, options.output, make_presenter, log, report);
    for (bool is_member = true;;) {
        try {
            if (!is_member && !(await_scene(options, blobs, clock, report, interrupts.token()) && join()))
                return tools::ExitInterrupted;
            player.run(options.frames, interrupts.token());
            return 0;
        } catch (const Error& error) {
            // Pending requests are rejected one by one when the scene is closed.
            if (error.code() != ErrorCode::Refused || interrupts.token().stop_requested()) throw;
            is_member = false;
        }
    }
}

}  // namespace

int main(int argc, char** argv) {
    disable_malloc_trim();
    Options options;
    cli::CommandLine line(
        "tessera-display",
        "Shows one output of the display of a live scene, frame-locked with all other outputs.");
    line.option("--master", "address of the master: tcp://host:port", options.address.endpoint);
    line.option(
        "--keys",
        "keys of the cluster: a folder, or an exported file; without keys the connection is not encrypted",
        options.address.keys);
    line.option("--user", "key pair to use from the folder of keys; the role viewer suffices",
                options.address.user);
    line.option("--output", "name of the output in the display file that this process shows", options.output);
    line.flag("--window", "in a window of the output's size, instead of the full screen", options.window);
    line.flag("--headless", "without a window; see --png and --shm for the pictures", options.headless);
    line.option("--png", "headless: keep FOLDER/OUTPUT.png updated with the current picture", options.png);
    line.option("--shm", "headless: show in POSIX shared memory of this name, as /left", options.shm);
    line.option("--log", "append a log of presented frames to this file, one JSON object per line",
                options.log);
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
        return usage("--png and --shm require --headless");
    if (!options.png.empty() && !options.shm.empty()) return usage("--png and --shm exclude each other");
    if (!options.shm.empty() &&
        (!options.shm.starts_with('/') || options.shm.find('/', 1) != std::string::npos))
        return usage("--shm: the name must begin with a slash and have no other, as /left");
    try {
        return show(options);
    } catch (const Error& error) {
        std::cerr << "tessera-display: " << error.what() << "\n";
        return tools::exit_code(error.code());
    }
}
