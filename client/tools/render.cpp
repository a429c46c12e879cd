#include "client/tools/render.h"

#include <filesystem>
#include <iostream>
#include <memory>

#include "client/session.h"
#include "client/tools/cluster_options.h"
#include "client/tools/interrupts.h"
#include "client/tools/pictures.h"
#include "client/tools/progress_line.h"
#include "client/tools/render_options.h"
#include "client/tools/render_report.h"
#include "mediator/frame/resolve.h"

namespace tessera::tools {

namespace {

constexpr const char* Name = "render";

// Ids that a master lends first; a scene imported with them need not be read again.
constexpr ObjectId UsualFirstId{1u << 16};

master::EventSink quiet_log(const cli::Log& log) {
    return [&log](const master::Event& event) {
        switch (event.severity) {
            case wire::Severity::Info:
                return log.debug(event.text);
            case wire::Severity::Warning:
                return log.warning(event.text);
            case wire::Severity::Error:
                return log.error(event.text);
        }
    };
}

// One run of the command, from the options to the files. Its steps return an exit code when they end it.
class Render {
  public:
    Render(RenderPlan plan, const RenderOptions& options)
        : plan_(std::move(plan)), json_(options.json), log_(options.log) {}

    int run() {
        if (const auto code = import(UsualFirstId)) return *code;
        if (stopped()) return interrupted("nothing was rendered");
        connect();
        if (const auto code = bring_in_scene()) return *code;
        render();
        return finish();
    }

  private:
    bool stopped() const { return interrupts_.token().stop_requested(); }

    int interrupted(const std::string& what) const {
        return complain(Name, ExitInterrupted, "interrupted; " + what);
    }

    std::optional<int> import(ObjectId first_id) {
        plan_.view.import.first_id = first_id;
        auto scene = import_scene(plan_.view);
        if (!scene) return complain(Name, ExitBadInput, scene.error().what());
        scene_ = std::move(*scene);
        auto camera = choose_camera(scene_.cameras, plan_.view.camera);
        if (!camera) return complain(Name, cli::ExitUsage, camera.error().what());
        camera_ = std::move(*camera);
        for (const scene::BlobPtr& blob : scene_.blobs) blobs_->insert(blob);
        return std::nullopt;
    }

    void connect() {
        if (plan_.address) {
            session_ = client::connect(*plan_.address, blobs_, clock_, session_settings("tessera render"));
            return;
        }
        embedded_.emplace(plan_.embedded, blobs_, clock_, quiet_log(log_));
        client::SessionSettings settings = session_settings("tessera render");
        settings.lost_limit = std::chrono::minutes(10);  // silence in here is a busy machine
        session_ = std::make_unique<client::Session>(embedded_->client(), std::function<void()>(), blobs_,
                                                     clock_, settings);
    }

    std::optional<int> bring_in_scene() {
        const std::string title = std::filesystem::path(plan_.view.scene).filename().string();
        const auto outcome = session_->open_scene(
            title, plan_.when_busy,
            [this](std::uint32_t place) {
                log_.info("the cluster is busy: waiting, place " + std::to_string(place) + " in the queue");
            },
            interrupts_.token());
        if (std::holds_alternative<client::Stopped>(outcome)) return interrupted("nothing was rendered");
        if (const auto* busy = std::get_if<client::Busy>(&outcome)) {
            return complain(Name, cli::ExitTryLater, busy->reason);
        }
        const auto& opened = std::get<client::OpenedScene>(outcome);
        if (opened.first_id != plan_.view.import.first_id) {
            if (const auto code = import(opened.first_id)) return code;
        }
        for (const std::string& notice : scene_.notices) log_.info(notice);
        const auto submitted =
            session_->submit(entries(scene_, import::RootEntry::Update), interrupts_.token());
        if (!submitted) return interrupted("nothing was rendered");
        for (const std::string& problem : submitted->problems) log_.error(problem);
        if (!submitted->accepted) return complain(Name, ExitBadInput, "the master does not take the scene");
        return std::nullopt;
    }

    void render() {
        plan_.job.view = view_from(plan_.view, camera_);
        ProgressLine line;
        result_ = session_->render(
            plan_.job, [&](const client::Progress& progress) { line.show(describe(progress, plan_.job)); },
            interrupts_.token());
    }

    // The pictures of what there is, unless there is nothing; then the reason decides.
    int finish() {
        using client::Outcome;
        const bool is_failed = result_.outcome == Outcome::Failed;
        if (is_failed) return complain(Name, ExitInternal, "the frame failed: " + result_.message);
        if ((!result_.film && !result_.picture) || result_.samples == 0) {
            if (result_.outcome == Outcome::Stopped) return interrupted("nothing was rendered yet");
            return complain(Name, cli::ExitUnavailable,
                            result_.message.empty() ? "no sample was finished in the time given: give it more"
                                                    : result_.message);
        }
        const std::string hash = result_.film ? to_hex(frame::film_hash(*result_.film)) : std::string();
        write_pictures(plan_.outputs, plan_.job, result_,
                       {std::filesystem::path(plan_.view.scene).filename().string(), camera_.name, hash},
                       plan_.statistics);
        const RenderReport report{plan_.job, result_, seconds(clock_.now() - started_), hash};
        std::cout << (json_ ? as_json(report) : as_text(report, plan_.outputs)) << std::endl;
        if (result_.outcome == Outcome::Stopped) return interrupted("what was merged so far is written");
        if (result_.outcome == Outcome::NoNodes) return complain(Name, cli::ExitUnavailable, result_.message);
        return 0;
    }

    Interrupts interrupts_;  // before anything that starts threads
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
    client::JobResult result_;
};

int run(const RenderOptions& options) {
    auto plan = understand(options);
    if (!plan) return complain(Name, cli::ExitUsage, plan.error().what());
    try {
        return Render(std::move(*plan), options).run();
    } catch (const Error& error) {
        return complain(Name, exit_code(error.code()), error.what());
    }
}

}  // namespace

Command render_command(cli::CommandLine& program) {
    const auto options = std::make_shared<RenderOptions>();
    options->add_to(program.command(Name, "Render a scene to pictures, in this process or on a cluster."));
    return {Name, [options](std::string_view) { return run(*options); }};
}

}  // namespace tessera::tools
