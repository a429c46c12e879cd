#include "tests/bench/live/displays_bench.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <sstream>
#include <thread>

#include "mediator/display/display.h"
#include "mediator/scene/fields.h"
#include "tests/bench/live/live_cluster.h"

namespace tessera::tools::bench {

namespace {

using namespace std::chrono_literals;

struct OutputSize {
    std::uint32_t width = 0, height = 0;
};

// A flat wall two metres in front of the head.
display::Display wall_of(const DisplaysOptions& options, OutputSize size, display::Stereo stereo) {
    display::Display wall{.name = "bench"};
    const double pixel = 6.0 / (options.columns * size.width);
    for (std::uint32_t row = 0; row < options.rows; ++row) {
        for (std::uint32_t column = 0; column < options.columns; ++column) {
            display::Output output{.name = std::to_string(row) + "-" + std::to_string(column),
                                   .width = size.width,
                                   .height = size.height,
                                   .stereo = stereo};
            output.view_width = size.width;
            output.view_height = size.height;
            const double left = pixel * size.width * (column - 0.5 * options.columns);
            const double top = pixel * size.height * (0.5 * options.rows - row);
            const double right = left + pixel * size.width, bottom = top - pixel * size.height;
            output.plane = {
                {left, bottom, -2.0},
                {1, 0, 0},
                {0, 1, 0},
                {{left, bottom, -2.0}, {right, bottom, -2.0}, {left, top, -2.0}, {right, top, -2.0}}};
            wall.outputs.push_back(std::move(output));
        }
    }
    wall.spp = 1;
    wall.coarsest = 1;
    wall.rate = 1000.0;
    return wall;
}

double cpu_seconds(pid_t pid) {
    std::ifstream file("/proc/" + std::to_string(pid) + "/stat");
    std::string text((std::istreambuf_iterator<char>(file)), {});
    const std::size_t name_end = text.rfind(')');
    if (name_end == std::string::npos) return 0.0;
    std::istringstream fields(text.substr(name_end + 2));
    std::string skipped;
    for (int i = 3; i < 14; ++i) fields >> skipped;
    double user = 0, system = 0;
    fields >> user >> system;
    return (user + system) / static_cast<double>(sysconf(_SC_CLK_TCK));
}

struct DisplayedFrame {
    std::set<std::uint64_t> versions;
    std::size_t outputs = 0;
    std::int64_t first = 0, last = 0;  // ns
};

// A cluster with a scene of one camera, a display in front of it, and a process for each output.
class Wall {
  public:
    Wall(const DisplaysOptions& options, Encryption encryption, display::Display wall)
        : cluster_(options.nodes, options.backend, encryption), wall_(std::move(wall)) {
        editor_ = cluster_.join("bench", blobs_, clock_);
        const ObjectId camera = editor_->new_id(), camera_transform = editor_->new_id();
        const auto accepted_edit = editor_->submit(
            {scene::Create{camera, scene::Camera{.name = "head"}},
             scene::Create{camera_transform,
                           scene::Transform{.name = "head transform", .children = {camera}}},
             scene::Update{scene::RootId, scene::Fields<scene::Root>(&scene::Root::children).bits(),
                           scene::Root{.children = {camera_transform}}}});
        if (!accepted_edit.accepted) throw Error(ErrorCode::Internal, accepted_edit.problems.front());
        for (const display::Output& output : wall_.outputs) {
            std::vector<std::string> arguments{"--master",    cluster_.endpoint(), "--output",
                                               output.name,   "--headless",        "--log",
                                               log_of(output)};
            if (encryption == Encryption::Curve)
                arguments.insert(arguments.end(), {"--keys", cluster_.keys().string(), "--user", "editor"});
            processes_.emplace_back(cluster_.folder(), "output-" + output.name,
                                    program_folder() / "tessera-display", arguments);
        }
    }

    TimePoint open() {
        const TimePoint now = clock_.now();
        editor_->open_display(wall_);
        return now;
    }
    void wait_until_all_showed(std::uint64_t frames, std::stop_token stop) {
        const TimePoint limit = clock_.now() + 120s;
        while (!stop.stop_requested()) {
            const auto status = cluster_.status(clock_).display;
            const bool all =
                !status.outputs.empty() &&
                std::all_of(status.outputs.begin(), status.outputs.end(), [&](const auto& output) {
                    return output.state == session::OutputState::Locked && output.frames >= frames;
                });
            if (all) return;
            if (clock_.now() > limit) {
                throw Error(ErrorCode::Unavailable, "the outputs did not start: " + processes_.front().err());
            }
            std::this_thread::sleep_for(50ms);
        }
    }

    LockRun measure(double run_seconds, std::stop_token stop) {
        LockRun run{.seconds = run_seconds};
        const auto before = cluster_.status(clock_);
        const double master = cpu_seconds(cluster_.master_pid()), nodes = cpu_of(cluster_.node_pids()),
                     outputs = outputs_cpu();
        const TimePoint start = clock_.now();
        const TimePoint end =
            start + std::chrono::duration_cast<Duration>(std::chrono::duration<double>(run_seconds));
        for (std::uint64_t step = 0; clock_.now() < end && !stop.stop_requested(); ++step) {
            // A new head position some hundred times a second, so that a new picture is always due.
            editor_->move_head(
                {.position = {0.3 * std::sin(0.01 * double(step)), 0.1 * std::cos(0.007 * double(step)), 0}});
            std::this_thread::sleep_for(2ms);
        }
        run.master_cpu = cpu_seconds(cluster_.master_pid()) - master;
        run.nodes_cpu = cpu_of(cluster_.node_pids()) - nodes;
        run.outputs_cpu = outputs_cpu() - outputs;
        const auto after = cluster_.status(clock_);
        run.film_bytes = after.wire_bytes.film - before.wire_bytes.film;
        for (std::size_t i = 0; i < after.display.outputs.size(); ++i)
            run.late += after.display.outputs[i].late - before.display.outputs.at(i).late;
        read_logs(start.time_since_epoch().count(), end.time_since_epoch().count(), run);
        return run;
    }
    std::uint64_t master_peak() const { return cluster_.master_peak_memory(); }
    // Time in ns at which the last output showed its first frame.
    std::int64_t all_shown_at() const {
        std::int64_t last = 0;
        for (const display::Output& output : wall_.outputs) {
            std::ifstream file(log_of(output));
            std::string line;
            if (std::getline(file, line))
                last = std::max(last, nlohmann::json::parse(line)["shown"].get<std::int64_t>());
        }
        return last;
    }

  private:
    std::string log_of(const display::Output& output) const {
        return (cluster_.folder() / (output.name + ".log")).string();
    }
    static double cpu_of(const std::vector<pid_t>& pids) {
        double sum = 0.0;
        for (const pid_t pid : pids) sum += cpu_seconds(pid);
        return sum;
    }
    double outputs_cpu() const {
        double sum = 0.0;
        for (const ChildProcess& process : processes_) sum += cpu_seconds(process.pid());
        return sum;
    }
    void read_logs(std::int64_t from, std::int64_t to, LockRun& run) const {
        std::map<std::uint64_t, DisplayedFrame> frames;
        for (const display::Output& output : wall_.outputs) {
            std::ifstream file(log_of(output));
            for (std::string line; std::getline(file, line);) {
                const auto entry = nlohmann::json::parse(line, nullptr, false);
                if (entry.is_discarded()) continue;  // the last line may be half written
                DisplayedFrame& shown = frames[entry["frame"].get<std::uint64_t>()];
                const auto when = entry["shown"].get<std::int64_t>();
                shown.versions.insert(entry["version"].get<std::uint64_t>());
                shown.first = shown.outputs == 0 ? when : std::min(shown.first, when);
                shown.last = std::max(shown.last, when);
                ++shown.outputs;
            }
        }
        std::vector<double> spreads;
        for (const auto& [number, shown] : frames) {
            run.mixed += shown.versions.size() > 1 ? 1 : 0;
            if (shown.outputs < wall_.outputs.size() || shown.first < from || shown.last > to) continue;
            ++run.frames;
            spreads.push_back(1e-9 * static_cast<double>(shown.last - shown.first));
        }
        if (spreads.empty()) return;
        std::sort(spreads.begin(), spreads.end());
        run.spread_p50 = spreads[spreads.size() / 2];
        run.spread_p99 = spreads[spreads.size() * 99 / 100];
    }

    SteadyClock clock_;
    std::shared_ptr<scene::BlobStore> blobs_ = std::make_shared<scene::BlobStore>();
    LiveCluster cluster_;
    display::Display wall_;
    std::unique_ptr<client::Session> editor_;
    std::vector<ChildProcess> processes_;
};

}  // namespace

DisplaysResults run_displays(const DisplaysOptions& options,
                             const std::function<void(const std::string&)>& report, std::stop_token stop) {
    DisplaysResults results;
    struct Case {
        const char* name;
        OutputSize size;
        Encryption encryption;
    };
    // A quarter of the thesis' 1440 x 1050 projectors; and the cost of the barrier alone.
    for (const Case& each : {Case{"a quarter of 1440x1050", {360, 262}, Encryption::Curve},
                             Case{"the same, not encrypted", {360, 262}, Encryption::None},
                             Case{"the barrier alone", {32, 32}, Encryption::Curve}}) {
        if (stop.stop_requested()) return results;
        report(std::string("frame lock: ") + each.name);
        Wall wall(options, each.encryption, wall_of(options, each.size, display::Stereo::Mono));
        wall.open();
        wall.wait_until_all_showed(1, stop);
        LockRun run = wall.measure(options.seconds, stop);
        run.name = each.name;
        run.outputs = options.columns * options.rows;
        run.width = each.size.width;
        run.height = each.size.height;
        run.encrypted = each.encryption == Encryption::Curve;
        results.locks.push_back(run);
    }
    if (!options.wall || stop.stop_requested()) return results;
    report("a stereo wall of 1440x1050 projectors");
    Wall wall(options, Encryption::Curve, wall_of(options, {1440, 1050}, display::Stereo::Separate));
    const TimePoint opened = wall.open();
    wall.wait_until_all_showed(1, stop);
    results.wall.pixels = std::uint64_t{2} * options.columns * options.rows * 1440 * 1050;
    results.wall.seconds =
        1e-9 * static_cast<double>(wall.all_shown_at() - opened.time_since_epoch().count());
    results.wall.master_peak_bytes = wall.master_peak();
    return results;
}

}  // namespace tessera::tools::bench
