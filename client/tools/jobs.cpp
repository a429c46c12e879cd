#include "client/tools/jobs.h"

#include <algorithm>
#include <ctime>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "client/session.h"
#include "client/tools/cluster_options.h"
#include "client/tools/formatted.h"
#include "client/tools/pictures.h"
#include "mediator/picture/atomic_file.h"

namespace tessera::tools {

namespace {

using Json = nlohmann::ordered_json;
constexpr const char* JobsName = "jobs";
constexpr const char* FetchName = "fetch";

struct JobsOptions {
    client::Address address{.endpoint = "tcp://127.0.0.1:7420"};
    std::string cancel, owner;
    bool json = false;
};

struct FetchOptions {
    client::Address address{.endpoint = "tcp://127.0.0.1:7420"};
    std::string name, owner, output;
    bool remove = false;
};

double progress_fraction(const session::JobStatus& job) {
    if (job.has_ended) return 1.0;
    return double(job.progress.samples) / double(std::max<std::uint64_t>(job.progress.samples_expected, 1));
}

// 0: unknown.
Json noise_value(double noise) {
    return noise > 0.0 ? Json(noise) : Json();
}

Json job_value(const session::JobStatus& job) {
    Json value{{"name", job.job.name},
               {"user", job.job.user},
               {"scene", job.scene},
               {"ended", job.has_ended},
               {"done", progress_fraction(job)},
               {"samples", job.progress.samples},
               {"noise", noise_value(job.has_ended ? job.summary.noise : job.progress.noise)},
               {"error", noise_value(job.has_ended ? job.summary.error : job.progress.error)},
               {"phase", job.has_ended ? Json() : Json(enumerator_name(job.progress.phase))},
               {"kept_until", job.kept_until == 0 ? Json() : Json(double(job.kept_until) * 1e-9)}};
    if (!job.has_ended) return value;
    const session::ViewSummary& summary = job.summary;
    value.update({{"outcome", enumerator_name(summary.outcome)},
                  {"message", summary.message},
                  {"samples", summary.samples},
                  {"seconds_render", summary.seconds_render},
                  {"picture", enumerator_name(summary.picture.encoding)},
                  {"picture_bytes", summary.picture.byte_size},
                  {"ended_at", double(job.ended_at) * 1e-9}});
    return value;
}

// An enumerator name with blanks instead of underscores.
std::string display_name(std::string_view enumerator) {
    std::string text(enumerator);
    std::ranges::replace(text, '_', ' ');
    return text;
}

// `since_1970` in ns.
std::string local_time(std::int64_t since_1970) {
    const auto seconds = static_cast<std::time_t>(since_1970 / 1'000'000'000);
    std::tm local{};
    ::localtime_r(&seconds, &local);
    char when[32];
    std::strftime(when, sizeof when, "%Y-%m-%d %H:%M", &local);
    return when;
}

std::string state_of(const session::JobStatus& job) {
    std::string text;
    if (job.has_ended) {
        text = display_name(enumerator_name(job.summary.outcome)) + " at " + local_time(job.ended_at);
        if (!job.summary.message.empty()) text += ": " + job.summary.message;
    } else {
        text = formatted("%3.0f %%  %s", 100.0 * progress_fraction(job),
                         display_name(enumerator_name(job.progress.phase)).c_str());
        if (job.progress.noise > 0.0) text += formatted(", noise %.3g", job.progress.noise);
        if (job.progress.error > 0.0) text += formatted(", error %.3g", job.progress.error);
    }
    if (job.kept_until != 0) text += "; its client was lost, kept until " + local_time(job.kept_until);
    return text;
}

int show_jobs(const JobsOptions& options) {
    const SteadyClock clock;
    const auto session = client::connect(options.address, std::make_shared<scene::BlobStore>(), clock,
                                         session_settings("tessera jobs"));
    if (!options.cancel.empty()) {
        session->cancel_job({.user = options.owner, .name = options.cancel});
        std::cout << "job '" << options.cancel << "' was cancelled" << std::endl;
        return 0;
    }
    const auto jobs = session->jobs();
    if (options.json) {
        Json all = Json::array();
        for (const session::JobStatus& job : jobs) all.push_back(job_value(job));
        std::cout << all.dump(2) << std::endl;
        return 0;
    }
    if (jobs.empty()) std::cout << "no jobs: submit one with tessera render ... --name NAME --detach\n";
    for (const session::JobStatus& job : jobs) {
        std::cout << formatted("%-20s %-12s %-20s ", job.job.name.c_str(), job.job.user.c_str(),
                               job.scene.c_str())
                  << state_of(job) << "\n";
    }
    return 0;
}

const char* extension(session::PictureEncoding encoding) {
    switch (encoding) {
        case session::PictureEncoding::Jpeg:
            return "jpg";
        case session::PictureEncoding::Exr:
            return "exr";
        default:
            return "png";
    }
}

bool is_running(client::Session& session, const session::JobName& job) {
    return std::ranges::any_of(session.jobs(), [&](const session::JobStatus& listed) {
        const bool is_meant =
            listed.job.name == job.name && (job.user.empty() || listed.job.user == job.user);
        return is_meant && !listed.has_ended;
    });
}

int fetch(const FetchOptions& options) {
    const SteadyClock clock;
    const auto session = client::connect(options.address, std::make_shared<scene::BlobStore>(), clock,
                                         session_settings("tessera fetch"));
    const session::JobName job{.user = options.owner, .name = options.name};
    client::ViewResult result;
    try {
        result = session->fetch_job(job);
    } catch (const Error& error) {
        if (error.code() != ErrorCode::Refused || !is_running(*session, job)) throw;
        return report_error(FetchName, cli::ExitTryLater, error.what());
    }
    const session::ViewSummary& summary = result.summary;
    if (!result.has_picture()) {
        return report_error(
            FetchName, cli::ExitUnavailable,
            "job '" + options.name + "' has no picture: " +
                (summary.message.empty() ? display_name(enumerator_name(summary.outcome)) : summary.message));
    }
    if (result.frame.encoding == session::PictureEncoding::Planes) {
        return report_error(FetchName, ExitBadInput,
                            "job '" + options.name +
                                "' has no picture file but raw pixel values: fetch it from the program that "
                                "submitted it");
    }
    const std::string kind = extension(result.frame.encoding);
    const std::string output = options.output.empty() ? options.name + "." + kind : options.output;
    if (picture_format(output) != picture_format("x." + kind)) {
        return report_error(
            FetchName, cli::ExitUsage,
            "-o: the picture of job '" + options.name + "' has the format ." + kind + ": use this extension");
    }
    picture::write_atomically(output,
                              std::string_view(reinterpret_cast<const char*>(result.frame.picture.data()),
                                               result.frame.picture.size()));
    std::cout << formatted("%ux%u pixels, %s, %.2f s rendering\n", result.frame.width, result.frame.height,
                           display_name(enumerator_name(summary.outcome)).c_str(), summary.seconds_render)
              << "wrote " << output << std::endl;
    if (options.remove) session->cancel_job(job);
    if (summary.outcome == session::Outcome::Incomplete)
        return report_error(FetchName, ExitIncomplete, summary.message);
    return 0;
}

template <class Options, class Call>
Command command(const char* name, const std::shared_ptr<Options>& options, const Call& call) {
    return {name, [name, options, call](std::string_view) {
                try {
                    return call(*options);
                } catch (const Error& error) {
                    return report_error(name, exit_code(error.code()), error.what());
                }
            }};
}

}  // namespace

Command jobs_command(cli::CommandLine& program) {
    const auto options = std::make_shared<JobsOptions>();
    cli::CommandLine& line =
        program.command(JobsName, "List your jobs on a cluster; operators see the jobs of all users.");
    line.option("--cancel", "stop the job of this name, or delete its picture if it has ended",
                options->cancel);
    line.option("--owner", "with --cancel, for operators: the user who submitted the job", options->owner);
    line.flag("--json", "print one JSON array", options->json);
    add_cluster_options(line, options->address);
    line.examples({"tessera jobs --master tcp://render-1:7420 --keys ~/.tessera",
                   "tessera jobs --cancel night --master tcp://127.0.0.1:7420"});
    return command(JobsName, options, show_jobs);
}

Command fetch_command(cli::CommandLine& program) {
    const auto options = std::make_shared<FetchOptions>();
    cli::CommandLine& line = program.command(
        FetchName,
        "Fetch the picture of a job that was submitted with render --detach, or whose client was lost.");
    line.positional("NAME", "name of the job; tessera jobs lists them", options->name);
    line.option("-o,--output", "file to write (default: NAME.png, .jpg or .exr, as requested at submission)",
                options->output);
    line.option("--owner", "for operators: the user who submitted the job", options->owner);
    line.flag("--remove", "delete the job on the master afterwards", options->remove);
    add_cluster_options(line, options->address);
    line.examples({"tessera fetch night -o night.png --master tcp://render-1:7420 --keys ~/.tessera",
                   "tessera fetch night --remove --master tcp://127.0.0.1:7420"});
    return command(FetchName, options, fetch);
}

}  // namespace tessera::tools
