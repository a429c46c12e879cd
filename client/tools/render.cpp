#include "client/tools/render.h"

#include <algorithm>
#include <filesystem>
#include <functional>
#include <iostream>
#include <memory>

#include "client/channel_session.h"
#include "client/render.h"
#include "client/tools/cluster_options.h"
#include "client/tools/continued_film.h"
#include "client/tools/frame_names.h"
#include "client/tools/frame_picture.h"
#include "client/tools/host_info.h"
#include "client/tools/interrupts.h"
#include "client/tools/pictures.h"
#include "client/tools/progress_line.h"
#include "client/tools/render_options.h"
#include "client/tools/render_report.h"
#include "client/tools/tev/viewer.h"
#include "mediator/frame/resolve.h"
#include "mediator/picture/exr_writer.h"

namespace tessera::tools {

namespace {

// The first ids that a master allocates; a scene imported with these need not be imported again.
constexpr ObjectId UsualFirstId{1u << 16};

master::EventSink quiet_log(const cli::Log& log) {
    return [&log](const master::Event& event) {
        if (event.is_detail) return log.debug(event.text, event.about);
        switch (event.severity) {
            case wire::Severity::Info:
                return log.debug(event.text, event.about);
            case wire::Severity::Warning:
                return log.warning(event.text, event.about);
            case wire::Severity::Error:
                return log.error(event.text, event.about);
        }
    };
}

// One run of the command, from the options to the files. Phases return an exit code if they end the run.
class Render {
  public:
    Render(RenderPlan plan, const RenderOptions& options)
        : name_(options.coverage ? "coverage" : "render"),
          plan_(std::move(plan)),
          json_(options.json),
          log_(options.log) {}

    int run() {
        if (const auto code = load_film()) return *code;
        if (const auto code = import(UsualFirstId)) return *code;
        if (stopped()) return interrupted("nothing was rendered");
        if (plan_.tev) viewer_.emplace(*plan_.tev, std::filesystem::path(plan_.outputs.front()).filename());
        if (plan_.sequence && !scene_.playback)
            return report_error(name_, ExitBadInput, "--frames: the scene has no animation");
        connect();
        if (const auto code = submit_scene()) return *code;
        if (plan_.sequence) return render_sequence();
        if (plan_.job.detached) return submit_job();
        render(plan_.view.view.seed);
        return plan_.coverage ? count() : finish(plan_.outputs);
    }

  private:
    bool stopped() const { return interrupts_.token().stop_requested(); }

    int fail(int code, const std::string& message) const {
        return report_error(name_, code, where_ + message);
    }
    int interrupted(const std::string& what) const {
        return fail(ExitInterrupted, "interrupted; " + (frame_ ? "the earlier frames were written" : what));
    }

    // The view is that of the film; it is needed before the scene is imported, which may depend on the picture's shape.
    std::optional<int> load_film() {
        if (!plan_.continued) return std::nullopt;
        film_ = read_continued_film(*plan_.continued);
        const std::string option = contradicting_option(plan_.given, plan_.view, film_->view);
        if (!option.empty()) return report_error(name_, cli::ExitUsage, other_view(option));
        const session::StopRule& stop = plan_.job.stop;
        if (stop.spp <= film_->least_samples)
            return report_error(name_, cli::ExitUsage,
                                "--spp: film '" + film_->path + "' has " +
                                    std::to_string(film_->least_samples) +
                                    " samples per pixel already; ask for more");
        if (film_->film.film.steps > 0 && !stop.has_steps())
            return report_error(
                name_, cli::ExitUsage,
                "film '" + film_->path +
                    "': its pixels have different numbers of samples (--noise, --error or --time): "
                    "continue it with one of them, --spp is an upper bound");
        if (plan_.job.reproducible && film_->kinds.find(';') != std::string::npos)
            return report_error(name_, ExitBadInput,
                                "--reproducible: film '" + film_->path +
                                    "' was rendered by nodes of several kinds: " + film_->kinds);
        plan_.view.size = {film_->view.width, film_->view.height};
        plan_.view.import.aspect_ratio = double(film_->view.width) / double(film_->view.height);
        plan_.job.tile = std::max(8u, film_->tile);
        return std::nullopt;
    }

    std::string other_view(const std::string& option) const {
        return option + ": film '" + film_->path +
               "' was rendered with another; leave it out to continue that";
    }

    std::optional<int> import(ObjectId first_id) {
        plan_.view.import.first_id = first_id;
        auto scene = import_scene(plan_.view);
        if (!scene) return report_error(name_, ExitBadInput, scene.error().what());
        scene_ = std::move(*scene);
        auto camera = choose_camera(scene_.cameras, plan_.view.camera);
        if (!camera) return report_error(name_, cli::ExitUsage, camera.error().what());
        camera_ = std::move(*camera);
        if (film_) {
            const ViewOptions& given = plan_.given;
            const bool is_given = given.camera || given.orthographic || given.lens_radius || given.focus ||
                                  !given.aperture.empty();
            if (is_given && view_from(plan_.view, camera_).camera != film_->view.camera)
                return report_error(name_, cli::ExitUsage, other_view("--camera and its lens"));
        }
        for (const scene::BlobPtr& blob : scene_.blobs) blobs_->insert(blob);
        return std::nullopt;
    }

    void connect() {
        if (plan_.address) {
            session_ = client::connect(*plan_.address, blobs_, clock_,
                                       session_settings("tessera " + name_, interrupts_.token()));
            return;
        }
        embedded_.emplace(plan_.embedded, blobs_, clock_, quiet_log(log_));
        client::SessionSettings settings = session_settings("tessera " + name_);
        settings.lost_limit = std::chrono::minutes(10);  // missed heartbeats mean a busy machine
        session_ = client::make_session(embedded_->client(), {}, blobs_, clock_, settings);
    }

    int render_sequence() {
        const FrameRange frames = plan_.sequence->frames;
        try {
            for (std::uint32_t frame = frames.first; frame <= frames.last; ++frame) {
                frame_ = frame;
                where_ = "frame " + std::to_string(frame) + ": ";
                if (stopped()) return interrupted("");
                if (const auto code = render_frame(frame)) return *code;
            }
        } catch (const Error& error) {
            throw Error(error.code(), where_ + error.what());
        }
        return 0;
    }

    // Returns an exit code if the sequence must end.
    std::optional<int> render_frame(std::uint32_t frame) {
        started_ = clock_.now();
        std::vector<std::string> outputs;
        for (const std::string& pattern : plan_.outputs) outputs.push_back(*frame_name(pattern, frame));
        const bool is_there = std::all_of(outputs.begin(), outputs.end(), [](const std::string& output) {
            return std::filesystem::exists(output);
        });
        if (is_there && plan_.sequence->skip_existing) {
            log_.info(where_ + "skipped, its output files exist");
            return std::nullopt;
        }
        auto step = move_to(scene_, plan_.sequence->seconds(frame));
        if (!step) return fail(ExitBadInput, step.error().what());
        for (const scene::BlobPtr& blob : step->blobs) blobs_->insert(blob);
        if (!step->entries.empty()) {
            if (const auto code = submit(std::move(step->entries))) return code;
        }
        camera_ = *choose_camera(scene_.cameras, plan_.view.camera);
        render(plan_.view.view.seed + frame);
        // Erases the blobs of earlier frames. Not earlier: nodes that share the store may still be loading a
        // previous version.
        blobs_->erase_unused();
        const int code = finish(outputs);
        return code == 0 ? std::nullopt : std::optional(code);
    }

    std::optional<int> submit(std::vector<scene::Entry> entries) {
        session_->submit_ahead(std::move(entries));
        if (!session_->settle(interrupts_.token())) return interrupted("nothing was rendered");
        const session::EditResult submitted = session_->take_results().back();
        for (const std::string& problem : submitted.problems) log_.error(where_ + problem);
        if (!submitted.accepted) return fail(ExitBadInput, "the master rejected the scene");
        return std::nullopt;
    }

    std::optional<int> submit_scene() {
        const std::string title = std::filesystem::path(plan_.view.scene).filename().string();
        const auto outcome = session_->join(
            {.title = title,
             .exclusive = true,
             .when_busy = plan_.when_busy,
             .on_place =
                 [this](std::uint32_t place) {
                     log_.info("the cluster is busy: waiting, queue position " + std::to_string(place));
                 }},
            interrupts_.token());
        if (std::holds_alternative<client::Stopped>(outcome)) return interrupted("nothing was rendered");
        if (const auto* busy = std::get_if<client::Busy>(&outcome)) {
            return report_error(name_, cli::ExitTryLater, busy->reason);
        }
        const auto& joined = std::get<client::Joined>(outcome);
        if (joined.first_id != plan_.view.import.first_id) {
            if (const auto code = import(joined.first_id)) return code;
        }
        for (const std::string& notice : scene_.notices) log_.info(title + ": " + notice);
        return submit(entries(scene_, import::RootEntry::Update));
    }

    int submit_job() {
        plan_.job.view = view_from(plan_.view, camera_);
        plan_.job.view.seed = plan_.view.view.seed;
        session_->request_view(1, plan_.job);
        std::cout << "job '" << plan_.job.name
                  << "' is submitted: tessera jobs shows its progress, tessera fetch " << plan_.job.name
                  << " downloads the picture" << std::endl;
        return 0;
    }

    void render(std::uint64_t seed) {
        plan_.job.view = view_from(plan_.view, camera_);
        plan_.job.view.seed = seed;
        if (film_) {
            plan_.job.view = film_->view;
            plan_.job.view.filter = plan_.view.view.filter;
        }
        ProgressLine line;
        const auto show = [&](const session::ViewProgress& progress) {
            line.show(where_ + describe(progress, plan_.job));
        };
        const std::function<void(const client::Frame&)> preview = [&](const client::Frame& frame) {
            const Rect& window = plan_.job.view.window;
            const frame::Image picture = picture_of(frame, static_cast<std::uint32_t>(window.width),
                                                    static_cast<std::uint32_t>(window.height));
            const bool is_denoised = !plan_.job.view.filter.empty();
            show_in_tev(
                layers_of(frame, picture, is_denoised ? Samples::AreDenoised : Samples::AreThePicture));
        };
        try {
            result_ = client::render(
                *session_, plan_.job, show, interrupts_.token(),
                plan_.sequence ? client::Session::AfterEnd::Keep : client::Session::AfterEnd::Close,
                film_ ? &film_->film : nullptr, viewer_ ? preview : nullptr);
        } catch (const Error& error) {
            if (!film_ || error.code() != ErrorCode::Refused) throw;
            throw Error(error.code(), "--continue '" + film_->path + "': " + error.what());
        }
    }

    void show_in_tev(const std::vector<picture::Layer>& layers) {
        if (const auto problem = viewer_->show(layers)) log_.warning(*problem);
    }

    // Complete pictures only: the fractions of a partial picture would be wrong.
    int count() {
        using session::Outcome;
        if (result_.summary.outcome == Outcome::Stopped) return interrupted("nothing was counted");
        if (result_.summary.outcome == Outcome::NoNodes)
            return fail(cli::ExitUnavailable, result_.summary.message);
        if (result_.summary.outcome == Outcome::Incomplete)
            return fail(ExitIncomplete, result_.summary.message);
        if (result_.summary.outcome != Outcome::Complete || !result_.film())
            return fail(ExitInternal, "the frame failed: " + result_.summary.message);
        const SampleGrid grid = *plan_.coverage;
        for (const std::string& output : plan_.outputs)
            write_picture(output, gather(frame::resolve_picture(*result_.film()), grid),
                          {view::ViewTransform::Linear, 0.0});
        const Coverage coverage = count_coverage(*result_.film(), scene_.objects);
        std::cout << (json_ ? as_json(coverage, grid.count()) : as_text(coverage, grid.count())) << std::endl;
        return 0;
    }

    // Writes what was rendered, even if incomplete; without any samples, reports the reason. Frames of a sequence
    // are written only if complete.
    int finish(const std::vector<std::string>& outputs) {
        using session::Outcome;
        const bool is_failed = result_.summary.outcome == Outcome::Failed;
        if (is_failed) return fail(ExitInternal, "the frame failed: " + result_.summary.message);
        if (frame_ && result_.summary.outcome == Outcome::Stopped) return interrupted("");
        if (frame_ && result_.summary.outcome == Outcome::NoNodes)
            return fail(cli::ExitUnavailable, result_.summary.message);
        if ((!result_.film() && !result_.has_picture()) || result_.summary.samples == 0) {
            if (result_.summary.outcome == Outcome::Stopped) return interrupted("nothing was rendered yet");
            return fail(cli::ExitUnavailable,
                        result_.summary.message.empty()
                            ? "no sample was finished within the time limit: raise --time"
                            : result_.summary.message);
        }
        const std::string hash = result_.film() ? to_hex(frame::film_hash(*result_.film())) : std::string();
        // A sequence keeps the exposure of its first frame.
        plan_.job.display_transform = used_transform(outputs, plan_.job, result_);
        const picture::CustomView* custom = plan_.custom_view ? &*plan_.custom_view : nullptr;
        picture::set_exr_threads(plan_.embedded.threads > 0 ? plan_.embedded.threads : core_count());
        write_pictures(outputs, plan_.job, result_,
                       {std::filesystem::path(plan_.view.scene).filename().string(), camera_.name, hash,
                        film_ ? listed_kinds(film_->kinds) : std::vector<std::string>()},
                       plan_.statistics, custom);
        if (viewer_) show_in_tev(layers_of(result_));
        std::vector<std::string> written = outputs;
        if (plan_.noise_map) {
            write_noise_map(*plan_.noise_map, *result_.film());
            written.push_back(*plan_.noise_map);
        }
        const RenderReport report{plan_.job, result_.summary, seconds(clock_.now() - started_),
                                  hash,      frame_,          custom};
        std::cout << (json_ ? as_json(report) : as_text(report, written)) << std::endl;
        if (result_.summary.outcome == Outcome::Stopped)
            return interrupted("the samples merged so far were written");
        if (result_.summary.outcome == Outcome::NoNodes)
            return report_error(name_, cli::ExitUnavailable, result_.summary.message);
        if (result_.summary.outcome == Outcome::Incomplete)
            return report_error(name_, ExitIncomplete, result_.summary.message);
        return 0;
    }

    Interrupts interrupts_;  // before anything that starts threads
    std::string name_;       // of the command
    RenderPlan plan_;
    bool json_;
    cli::Log log_;
    SteadyClock clock_;
    TimePoint started_ = clock_.now();
    std::shared_ptr<scene::BlobStore> blobs_ = std::make_shared<scene::BlobStore>();
    import::ImportedScene scene_;
    import::CameraInfo camera_;
    std::optional<EmbeddedCluster> embedded_;
    std::unique_ptr<client::Session> session_;  // says goodbye before the embedded cluster stops
    std::optional<tev::Viewer> viewer_;
    client::ViewResult result_;
    std::optional<ContinuedFilm> film_;
    std::optional<std::uint32_t> frame_;  // of a sequence, the one that is rendered
    std::string where_;                   // names it
};

int run(const RenderOptions& options) {
    const char* name = options.coverage ? "coverage" : "render";
    auto plan = parse_options(options);
    if (!plan) {
        const bool unavailable = plan.error().code() == ErrorCode::Unavailable;
        return report_error(name, unavailable ? cli::ExitUnavailable : cli::ExitUsage, plan.error().what());
    }
    try {
        return Render(std::move(*plan), options).run();
    } catch (const Error& error) {
        return report_error(name, exit_code(error.code()), error.what());
    }
}

}  // namespace

Command render_command(cli::CommandLine& program) {
    const auto options = std::make_shared<RenderOptions>();
    options->add_to(
        program.command("render", "Render a scene to pictures, in this process or on a cluster."));
    return {"render", [options](std::string_view) { return run(*options); }};
}

Command coverage_command(cli::CommandLine& program) {
    const auto options = std::make_shared<RenderOptions>();
    options->add_coverage_to(program.command(
        "coverage", "Report which objects a camera sees, and the fraction of the picture that each covers."));
    return {"coverage", [options](std::string_view) { return run(*options); }};
}

}  // namespace tessera::tools
