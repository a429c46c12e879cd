#include "tests/bench/filters/pictures.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <functional>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "client/channel_session.h"
#include "client/render.h"
#include "client/tools/embedded_cluster.h"
#include "client/tools/interrupts.h"
#include "client/tools/progress_line.h"
#include "client/tools/view_options.h"
#include "master/filter/catalog.h"
#include "mediator/backend/catalog.h"
#include "mediator/filter/choice.h"
#include "mediator/frame/resolve.h"
#include "mediator/picture/metrics.h"

namespace tessera::tools::bench {

namespace {

using Json = nlohmann::ordered_json;
using session::PictureEncoding;

struct PicturesOptions {
    ViewOptions view;
    std::string budget = "800ms", filter = "fdf", format = "png";
    std::uint64_t requests = 100, compared = 5, reference_spp = 512;
    bool json = false;
};

struct Request {
    double seconds = 0.0;           // from the request to the encoded file
    double prediction_error = 0.0;  // actual minus predicted time of filter and encoding
    std::uint64_t min_samples = 0;
    std::uint32_t scale = 1;
};

double quantile(std::vector<double> values, double part) {
    std::ranges::sort(values);
    const auto last = static_cast<double>(values.size() - 1);
    return values[static_cast<std::size_t>(std::lround(part * last))];
}

frame::Image linear(const client::Frame& picture) {
    frame::Image image(picture.width, picture.height, 3);
    for (std::size_t i = 0; i < image.pixel_count(); ++i) {
        for (std::size_t c = 0; c < 3; ++c) {
            std::memcpy(&image.values[3 * i + c], &picture.picture[(c * image.pixel_count() + i) * 4], 4);
        }
    }
    return image;
}

class PicturesBench {
  public:
    explicit PicturesBench(const PicturesOptions& options) : options_(options) {}

    int run() {
        const auto plan = parse_options(options_.view);
        if (!plan) return report_error("bench", cli::ExitUsage, plan.error().what());
        const auto budget = parse_duration(options_.budget);
        if (!budget)
            return report_error("bench", cli::ExitUsage, std::string("--budget: ") + budget.error().what());
        const auto choice = filter::parse_choice(options_.filter, filter::catalog());
        if (!choice)
            return report_error("bench", cli::ExitUsage, std::string("--filter: ") + choice.error().what());
        if (options_.requests == 0) return report_error("bench", cli::ExitUsage, "--requests: at least 1");
        if (const auto code = open(*plan)) return *code;
        request_.view = view_from(*plan, camera_);
        request_.view.channels = {frame::Channel::Radiance};
        request_.view.filter = filter::to_text(*choice);
        request_.stop = {.spp = session::MaxSamplesPerPixel, .budget = *budget, .adapts_size = true};
        request_.picture = options_.format == "jpg"   ? PictureEncoding::Jpeg
                           : options_.format == "exr" ? PictureEncoding::Exr
                                                      : PictureEncoding::Png;
        for (std::uint64_t i = 0; i < options_.requests && !stopped(); ++i) {
            line_.show("request " + std::to_string(i + 1) + " of " + std::to_string(options_.requests));
            requests_.push_back(ask(i + 1));
        }
        if (!stopped() && options_.compared > 0) compare();
        if (stopped()) return report_error("bench", ExitInterrupted, "interrupted; no results");
        report(seconds(*budget));
        return 0;
    }

  private:
    bool stopped() const { return interrupts_.token().stop_requested(); }

    std::optional<int> open(const ViewPlan& plan) {
        ViewPlan scene_plan = plan;
        scene_plan.import.first_id = ObjectId{1u << 16};
        auto scene = import_scene(scene_plan);
        if (!scene) return report_error("bench", ExitBadInput, scene.error().what());
        auto camera = choose_camera(scene->cameras, scene_plan.camera);
        if (!camera) return report_error("bench", cli::ExitUsage, camera.error().what());
        camera_ = *camera;
        for (const scene::BlobPtr& blob : scene->blobs) blobs_->insert(blob);
        cluster_.emplace(EmbeddedSettings{.backend = backend::catalog().front().name}, blobs_, clock_,
                         [](const master::Event&) {});
        session_ = client::make_session(cluster_->client(), {}, blobs_, clock_, {.name = "tessera bench"});
        session_->join({.title = "bench", .exclusive = true}, interrupts_.token());
        session_->submit_ahead(entries(*scene, import::RootEntry::Update));
        if (!session_->settle(interrupts_.token()) || !session_->take_results().back().accepted)
            return report_error("bench", ExitInternal, "the master rejected the scene");
        return std::nullopt;
    }

    client::ViewResult render(const session::ViewRequest& request) {
        client::ViewResult result = client::render(*session_, request, {}, interrupts_.token());
        const session::Outcome outcome = result.summary.outcome;
        if (outcome == session::Outcome::Failed || outcome == session::Outcome::NoNodes) {
            throw Error(ErrorCode::Internal, result.summary.message);
        }
        return result;
    }

    Request ask(std::uint64_t seed) {
        session::ViewRequest request = request_;
        request.view.seed = seed;
        const TimePoint started = clock_.now();
        const client::ViewResult result = render(request);
        Request done{.seconds = seconds(clock_.now() - started)};
        const session::PictureSummary& picture = result.summary.picture;
        if (!result.has_picture()) return done;
        done.min_samples = result.summary.min_samples;
        done.scale = picture.scale;
        done.prediction_error = picture.seconds_filter + picture.seconds_encode - picture.seconds_predicted;
        return done;
    }

    // The same budget with and without the filter, against a reference of another seed.
    void compare() {
        line_.show("rendering the reference");
        session::ViewRequest reference = request_;
        reference.view.filter.clear();
        reference.view.seed = 1'000'003;
        reference.stop.budget = Duration{};
        reference.stop.adapts_size = false;
        reference.stop.spp = options_.reference_spp;
        reference.film = true;
        reference.picture = PictureEncoding::None;
        const frame::Image truth = frame::resolve(*render(reference).film(), frame::Channel::Radiance);
        for (std::uint64_t i = 0; i < options_.compared && !stopped(); ++i) {
            line_.show("comparison " + std::to_string(i + 1) + " of " + std::to_string(options_.compared));
            session::ViewRequest request = request_;
            request.view.seed = 2'000'003 + i;
            request.picture = PictureEncoding::Planes;
            const client::ViewResult filtered = render(request);
            request.view.filter = "none";
            const client::ViewResult raw = render(request);
            if (!filtered.has_picture() || !raw.has_picture()) continue;
            filtered_relmse_.push_back(picture::relmse(linear(filtered.frame), truth));
            raw_relmse_.push_back(picture::relmse(linear(raw.frame), truth));
        }
    }

    void report(double budget) const {
        std::vector<double> times, errors;
        std::size_t on_time = 0, far_late = 0, scaled = 0;
        std::uint64_t least = ~std::uint64_t{0};
        for (const Request& request : requests_) {
            times.push_back(request.seconds);
            errors.push_back(request.prediction_error);
            on_time += request.seconds <= 1.05 * budget ? 1u : 0u;
            far_late += request.seconds > 1.25 * budget ? 1u : 0u;
            scaled += request.scale > 1 ? 1u : 0u;
            least = std::min(least, request.min_samples);
        }
        const auto mean = [](const std::vector<double>& values) {
            double sum = 0.0;
            for (const double value : values) sum += value;
            return values.empty() ? 0.0 : sum / static_cast<double>(values.size());
        };
        const double raw = mean(raw_relmse_), filtered = mean(filtered_relmse_);
        const Json object{{"scene", std::filesystem::path(options_.view.scene).filename().string()},
                          {"size", options_.view.size},
                          {"filter", request_.view.filter},
                          {"format", options_.format},
                          {"budget_seconds", budget},
                          {"requests", requests_.size()},
                          {"within_1_05", on_time},
                          {"above_1_25", far_late},
                          {"seconds_least", quantile(times, 0.0)},
                          {"seconds_median", quantile(times, 0.5)},
                          {"seconds_p95", quantile(times, 0.95)},
                          {"seconds_most", quantile(times, 1.0)},
                          {"prediction_error_median_seconds", quantile(errors, 0.5)},
                          {"prediction_error_most_seconds", quantile(errors, 1.0)},
                          {"samples_per_pixel_least", least},
                          {"rendered_smaller", scaled},
                          {"relmse_filtered", filtered},
                          {"relmse_unfiltered", raw},
                          {"relmse_ratio", raw > 0.0 ? filtered / raw : 0.0}};
        if (options_.json) {
            std::cout << object.dump(2) << "\n";
            return;
        }
        for (const auto& [key, value] : object.items()) {
            std::string name = key;
            std::ranges::replace(name, '_', ' ');
            name.resize(36, ' ');
            std::cout << name << (value.is_string() ? value.get<std::string>() : value.dump()) << "\n";
        }
    }

    Interrupts interrupts_;  // before anything that starts threads
    const PicturesOptions& options_;
    SteadyClock clock_;
    ProgressLine line_;
    std::shared_ptr<scene::BlobStore> blobs_ = std::make_shared<scene::BlobStore>();
    import::CameraInfo camera_;
    std::optional<EmbeddedCluster> cluster_;
    std::unique_ptr<client::Session> session_;
    session::ViewRequest request_;
    std::vector<Request> requests_;
    std::vector<double> filtered_relmse_, raw_relmse_;
};

}  // namespace

Command pictures_command(cli::CommandLine& bench) {
    const auto options = std::make_shared<PicturesOptions>();
    cli::CommandLine& line =
        bench.command("pictures", "Picture requests with a time budget: how many meet it, and their error.");
    options->view.size = "400x400";
    options->view.add_to(line);
    line.option("--budget", "time for each picture, filter and encoding included", options->budget);
    line.option("--filter", "denoiser, NAME[:key=value,...]", options->filter);
    line.choice("--format", "of the file", options->format, {"png", "jpg", "exr"});
    line.option("--requests", "number of consecutive pictures", options->requests);
    line.option("--compared", "pictures whose error is measured, with and without the filter; 0 = none",
                options->compared);
    line.option("--reference-spp", "samples per pixel of the reference picture", options->reference_spp);
    line.flag("--json", "print one JSON object", options->json);
    line.examples({"tessera bench pictures room.glb --requests 100 --size 400x400 --budget 800ms",
                   "tessera bench pictures room.glb --requests 20 --size 800x800 --budget 5s --json"});
    return {"bench pictures", [options](std::string_view) { return PicturesBench(*options).run(); }};
}

}  // namespace tessera::tools::bench
