#include "client/tools/watch.h"

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <iostream>
#include <memory>
#include <optional>
#include <utility>

#include "client/session.h"
#include "client/tools/cluster_options.h"
#include "client/tools/display_transform_options.h"
#include "client/tools/filter_options.h"
#include "client/tools/formatted.h"
#include "client/tools/frame_picture.h"
#include "client/tools/interrupts.h"
#include "client/tools/pictures.h"
#include "client/tools/terminal_picture.h"
#include "client/tools/tev/viewer.h"
#include "client/tools/values.h"
#include "mediator/picture/exposure.h"
#include "mediator/picture/picture_encoder.h"
#include "mediator/picture/view_transform.h"
#include "mediator/view/placed_cameras.h"

namespace tessera::tools {

namespace {

constexpr const char* WatchName = "watch";
constexpr std::uint64_t View = 1;

struct WatchOptions {
    client::Address address{.endpoint = "tcp://127.0.0.1:7420"};
    std::string title, name = "watch", view, camera;
    FilterOption filter;
    DisplayTransformOptions display;
    std::optional<std::string> size, output, noise_map, tev, time;
    std::uint64_t spp = 256;
    std::string adaptive = "on";
    std::uint64_t frames = 0;
    bool once = false, no_wait = false;
};

// Pictures for the eye are denoised, and light for other programs is as sampled, unless an option asks otherwise.
bool is_exr(const std::optional<std::string>& output) {
    return output && picture_format(*output) == PictureFormat::Exr;
}

// One run of the command: joins the scene, requests the view and shows its frames.
class Watch {
  public:
    explicit Watch(const WatchOptions& options) : options_(options) {}

    int run() {
        to_terminal_ = !options_.output && !options_.tev && is_terminal();
        if (!options_.output && !options_.tev && !to_terminal_)
            return report_error(
                WatchName, cli::ExitUsage,
                "cannot show the frames: standard output is not a terminal; add -o FILE or --tev HOST");
        if (options_.output && !picture_format(*options_.output))
            return report_error(WatchName, cli::ExitUsage,
                                "-o: the file name must end in .exr, .png or .jpg");
        if (options_.noise_map && picture_format(*options_.noise_map) != PictureFormat::Png)
            return report_error(WatchName, cli::ExitUsage,
                                "--noise-map: '" + *options_.noise_map + "' does not end with .png");
        const auto filter = parse_options(options_.filter);
        if (!filter) return report_error(WatchName, cli::ExitUsage, filter.error().what());
        filter_ = filter->empty() && !is_exr(options_.output) ? LiveFilter : *filter;
        const auto display = parse_options(options_.display);
        if (!display) return report_error(WatchName, cli::ExitUsage, display.error().what());
        display_ = *display;
        if (const auto unused =
                options_.output ? unused_display_options(options_.display, {*options_.output}) : std::nullopt)
            std::cerr << "tessera watch: " << *unused << "\n";
        std::optional<Duration> limit;
        if (options_.time) {
            const auto parsed = parse_duration(*options_.time);
            if (!parsed)
                return report_error(WatchName, cli::ExitUsage,
                                    std::string("--time: ") + parsed.error().what());
            limit = *parsed;
        }
        if (const auto code = choose_size()) return *code;
        if (options_.tev) {
            if (const auto fine = tev::check_address(*options_.tev); !fine)
                return report_error(WatchName, cli::ExitUsage, std::string("--tev: ") + fine.error().what());
        }
        if (options_.tev) viewer_.emplace(*options_.tev, "tessera watch");
        session_ = client::connect(options_.address, std::make_shared<scene::BlobStore>(), clock_,
                                   session_settings(options_.name, interrupts_.token()));
        const auto joined = session_->join(
            {.title = options_.title,
             .when_busy = options_.no_wait ? client::WhenBusy::GiveUp : client::WhenBusy::Queue,
             .on_place =
                 [](std::uint32_t place) {
                     std::cerr << "tessera watch: the cluster is busy: waiting, queue position " << place
                               << "\n";
                 }},
            interrupts_.token());
        if (std::holds_alternative<client::Stopped>(joined)) return ExitInterrupted;
        if (const auto* busy = std::get_if<client::Busy>(&joined))
            return report_error(WatchName, cli::ExitTryLater, busy->reason);
        open_view();
        return watch(limit ? clock_.now() + *limit : TimePoint::max());
    }

  private:
    std::optional<int> choose_size() {
        const TerminalSize terminal = terminal_size();
        size_ = to_terminal_ ? Size{terminal.columns, 2 * (terminal.rows - 1)} : Size{1280, 720};
        if (!options_.size) return std::nullopt;
        const auto size = parse_size(*options_.size);
        if (!size)
            return report_error(WatchName, cli::ExitUsage, std::string("--size: ") + size.error().what());
        size_ = *size;
        return std::nullopt;
    }

    void open_view() {
        session::ViewRequest request{.name = options_.view,
                                     .stop = {.spp = options_.spp, .uniform = options_.adaptive == "off"},
                                     .picture = session::PictureEncoding::Planes,
                                     .film = options_.noise_map || options_.tev};
        const bool is_shared = !options_.view.empty();
        if (!is_shared) {
            // There is no camera until a client loads a scene.
            while (!view::choose_camera(session_->scene(), "") && !interrupts_.token().stop_requested()) {
                if (!camera_wait_logged_)
                    std::cerr
                        << "tessera watch: the scene has no camera yet: waiting for a client to add one\n";
                camera_wait_logged_ = true;
                ::usleep(100000);
                session_->refresh();
            }
            const auto camera = view::choose_camera(session_->scene(), options_.camera);
            if (!camera) throw camera.error();
            request.view.width = size_.width;
            request.view.height = size_.height;
            request.view.window = {0, 0, static_cast<std::int32_t>(size_.width),
                                   static_cast<std::int32_t>(size_.height)};
            request.view.camera = view::pose(*camera, size_.width, size_.height);
            request.view.channels = {frame::Channel::Radiance};
            if (request.film) request.view.channels.insert(frame::Channel::BlockVariance);
            if (options_.tev) {
                for (const frame::Channel channel :
                     {frame::Channel::Albedo, frame::Channel::Normal, frame::Channel::Depth})
                    request.view.channels.insert(channel);
            }
            request.view.filter = filter_;
        }
        is_shared ? session_->share_view(View, request) : session_->request_view(View, request);
    }

    int watch(TimePoint end) {
        if (to_terminal_) std::cout << "\x1b[2J";
        std::uint64_t count = 0;
        bool is_complete = false;
        while (!interrupts_.token().stop_requested() && clock_.now() < end) {
            const auto frame = session_->next_frame(std::min(end, clock_.now() + std::chrono::seconds(1)),
                                                    interrupts_.token());
            for (const std::string& notice : session_->take_notices())
                std::cerr << "tessera watch: " << notice << "\n";
            if (!frame) continue;
            show(*frame, ++count);
            is_complete = frame->complete;
            if (options_.frames != 0 && count >= options_.frames) return 0;
            if (options_.once && is_complete) return 0;
        }
        if (interrupts_.token().stop_requested()) return options_.once ? ExitInterrupted : 0;
        return options_.once
                   ? report_error(WatchName, cli::ExitTryLater,
                                  "the time limit expired before the frame was complete: raise --time")
                   : 0;
    }

    void show(const client::Frame& frame, std::uint64_t count) {
        const std::uint32_t width = options_.view.empty() ? size_.width : frame.width * frame.scale;
        const std::uint32_t height = options_.view.empty() ? size_.height : frame.height * frame.scale;
        const frame::Image image = picture_of(frame, width, height);
        // Measured on the first frame that is not black, and kept: brightness must not pump while the scene is edited.
        if (!display_.transform.exposure) display_.transform.exposure = picture::measured_exposure(image);
        if (options_.output)
            write_picture(*options_.output, image, display_.transform, display_.custom_view());
        if (viewer_) show_in_tev(frame, image);
        // Of coarse pictures, with one sample a pixel, no noise is known.
        if (options_.noise_map && frame.scale == 1 && frame.film) write_noise(*frame.film);
        char text[200];
        std::snprintf(text, sizeof text, "frame %llu, version %llu, %ux%u%s, %.4g of %llu samples%s%s",
                      static_cast<unsigned long long>(count),
                      static_cast<unsigned long long>(frame.version.number), frame.width, frame.height,
                      frame.scale > 1 ? (" (1/" + std::to_string(frame.scale) + ")").c_str() : "",
                      frame.mean_samples, static_cast<unsigned long long>(frame.spp),
                      frame.noise > 0.0 ? formatted(", noise %.3g", frame.noise).c_str() : "",
                      frame.complete ? ", complete" : "");
        if (to_terminal_) {
            const auto rgb = picture::display_bytes(image, display_.transform, display_.custom_view());
            const std::string picture = terminal_picture(width, height, rgb);
            std::cout << picture << text << "\x1b[K" << std::flush;
        } else {
            std::cout << text << std::endl;
        }
    }

    void show_in_tev(const client::Frame& frame, const frame::Image& image) {
        // The filter of another's view is not known here.
        const bool shows_samples = options_.view.empty() && (filter_.empty() || filter_ == "none");
        const Samples samples = shows_samples ? Samples::AreThePicture : Samples::AreDenoised;
        if (const auto problem = viewer_->show(layers_of(frame, image, samples)))
            std::cerr << "tessera watch: " << *problem << "\n";
    }

    void write_noise(const frame::FilmTile& film) {
        if (film.channels.contains(frame::Channel::Radiance))
            return write_noise_map(*options_.noise_map, film);
        if (!std::exchange(has_no_noise_, true))
            std::cerr << "tessera watch: no noise map: the samples of this view have no radiance\n";
    }

    Interrupts interrupts_;  // before anything that starts threads
    WatchOptions options_;
    SteadyClock clock_;
    Size size_;
    DisplayChoice display_;
    std::string filter_;
    bool to_terminal_ = false, camera_wait_logged_ = false, has_no_noise_ = false;
    std::optional<tev::Viewer> viewer_;
    std::unique_ptr<client::Session> session_;
};

int run(const WatchOptions& options) {
    try {
        return Watch(options).run();
    } catch (const Error& error) {
        return report_error(WatchName, exit_code(error.code()), error.what());
    }
}

}  // namespace

Command watch_command(cli::CommandLine& program) {
    const auto options = std::make_shared<WatchOptions>();
    cli::CommandLine& line =
        program.command(WatchName,
                        "Watch a live scene in the terminal, or in a picture file that is updated with every "
                        "frame. The picture is denoised "
                        "by psvgf unless it is an .exr; --denoise=none shows the samples.");
    add_cluster_options(line, options->address);
    line.option("--name", "name of this client, as other members see it", options->name);
    line.option("--scene", "title of the scene, if a new one is opened", options->title);
    line.option("--view", "watch this view of another client; tessera edit -c members lists them",
                options->view);
    line.option("--camera", "camera of the scene, by name or by number from 0", options->camera);
    line.option("--size", "picture size in pixels (default: 1280x720, or the size of the terminal)",
                options->size);
    line.option("--spp", "samples per pixel of the complete frame, in the mean", options->spp);
    line.choice("--adaptive", "on: pixels get the samples that they need; off: all get as many",
                options->adaptive, {"on", "off"});
    options->filter.add_to(line);
    options->display.add_to(line);
    line.option("-o,--output", "write every frame to this picture, .png, .jpg or .exr", options->output);
    line.option("--noise-map",
                "also write a PNG of the noise of each pixel, from 0.01 (black) over 0.1 (red) to 1 (white)",
                options->noise_map);
    line.option(
        "--tev",
        "show every frame and its layers (albedo, normal, depth, noise and more) in the image viewer tev "
        "at HOST or HOST:PORT (default port: 14158)",
        options->tev);
    line.flag("--once", "exit when the frame is complete", options->once);
    line.option("--frames", "exit after this many frames; 0 = never", options->frames);
    line.option("--time", "exit after this time, as 10s or 5m", options->time);
    line.flag("--no-wait", "exit with 75 if a batch job uses the cluster, instead of waiting",
              options->no_wait);
    line.examples({"tessera watch --master tcp://render-1:7420 --keys ~/.tessera",
                   "tessera watch --master tcp://127.0.0.1:7420 -o now.png --once --spp 64",
                   "tessera watch --master tcp://127.0.0.1:7420 --tev localhost",
                   "tessera watch --master tcp://127.0.0.1:7420 --view ann/1"});
    return {WatchName, [options](std::string_view) { return run(*options); }};
}

}  // namespace tessera::tools
