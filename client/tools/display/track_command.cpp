#include "client/tools/display/track_command.h"

#include <algorithm>
#include <iostream>
#include <memory>
#include <thread>

#include "client/tools/cluster_options.h"
#include "client/tools/display/head_socket.h"
#include "client/tools/display/live_display.h"
#include "client/tools/interrupts.h"

namespace tessera::tools {

namespace {

using namespace std::chrono_literals;

constexpr const char* TrackName = "display track";
constexpr Duration Interval = std::chrono::nanoseconds(1s) / 240;  // minimum between two head updates
constexpr Duration PollInterval = 100ms;  // polling interval for a stop and for the master's notices

struct TrackOptions {
    client::Address address;
    std::string bind = "127.0.0.1";
    std::uint32_t port = 0;
};

// Forwards the newest head pose continuously.
class Tracking {
  public:
    explicit Tracking(const TrackOptions& options)
        : socket_(options.bind, static_cast<std::uint16_t>(options.port)),
          member_(join_display(options.address, "tessera display track", clock_, interrupts_.token())) {
        std::cout << "display '" << member_.display << "' follows heads received on UDP " << options.bind
                  << " port " << socket_.port() << std::endl;
    }

    void run() {
        while (!interrupts_.token().stop_requested()) {
            socket_.wait(PollInterval);
            const TimePoint began = clock_.now();
            const HeadSocket::Packets packets = socket_.drain();
            if (packets.newest) member_.session->move_head(*packets.newest);
            member_.session->pump();
            count(packets, began);
            if (packets.good + packets.bad > 0) std::this_thread::sleep_until(began + Interval);
        }
        std::cout << good_ << " packets, " << sent_ << " heads forwarded, " << bad_ << " bad packets"
                  << std::endl;
    }

  private:
    void count(const HeadSocket::Packets& packets, TimePoint now) {
        good_ += packets.good;
        bad_ += packets.bad;
        sent_ += packets.newest ? 1 : 0;
        if (packets.bad > 0) problem_ = packets.problem;
        if (bad_ == reported_ || now < report_at_) return;
        std::cerr << "tessera display track: " << bad_ - reported_ << " bad packets, the latest " << problem_
                  << std::endl;
        reported_ = bad_;
        report_at_ = now + 1s;
    }

    Interrupts interrupts_;  // before starting any thread
    SteadyClock clock_;
    HeadSocket socket_;
    DisplayMember member_;
    std::uint64_t good_ = 0, bad_ = 0, sent_ = 0, reported_ = 0;
    std::string problem_;
    TimePoint report_at_{};
};

int run(const TrackOptions& options) {
    if (options.port > 65535)
        return report_error(TrackName, cli::ExitUsage,
                            "--udp: a port is within 1 and 65535, or 0 for any free one");
    Tracking(options).run();
    return 0;
}

}  // namespace

Command track_command(cli::CommandLine& display) {
    const auto options = std::make_shared<TrackOptions>();
    cli::CommandLine& line = display.command("track",
                                             "Let the open display follow a tracked head. Receives UDP "
                                             "packets of one line of text, x y z or x y z qw "
                                             "qx qy qz, in metres in display space, optionally after the "
                                             "word head. Forwards the latest, at most 240 "
                                             "per second. UDP is not authenticated: any host that can reach "
                                             "the port can move the head (and nothing "
                                             "else), so bind it to a separate network of the tracker.");
    line.option("--udp", "port to receive packets on; 0 = any free port, which is printed", options->port);
    line.required("--udp");
    line.option("--bind", "numeric address of this machine to listen on", options->bind);
    add_cluster_options(line, options->address);
    line.required("--master");
    line.examples({"tessera display track --udp 7500 --master tcp://127.0.0.1:7420",
                   "tessera display track --udp 7500 --bind 10.0.9.1 --master tcp://render-1:7420 --keys "
                   "~/.tessera"});
    return {TrackName, [options](std::string_view) {
                try {
                    return run(*options);
                } catch (const Error& error) {
                    return report_error(TrackName, exit_code(error.code()), error.what());
                }
            }};
}

}  // namespace tessera::tools
