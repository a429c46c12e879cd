#include "client/tools/render_options.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <iostream>

#include "client/tools/frame_names.h"
#include "client/tools/pictures.h"
#include "client/tools/tev/viewer.h"
#include "mediator/backend/catalog.h"
#include "mediator/base/nearest.h"

namespace tessera::tools {

namespace {

constexpr std::uint64_t MaxSpp = std::uint64_t{1} << 31;
constexpr std::uint64_t MaxNodes = 64, MaxThreads = 1024;

tl::unexpected<Error> wrong(const std::string& message) {
    return failure(ErrorCode::InvalidInput, message);
}

std::vector<std::string> backend_names() {
    std::vector<std::string> names;
    for (const backend::BackendEntry& entry : backend::catalog()) names.push_back(entry.name);
    return names;
}

Expected<void> check_place(const std::string& option, const std::string& output) {
    const std::filesystem::path folder = std::filesystem::path(output).parent_path();
    if (!folder.empty() && !std::filesystem::is_directory(folder))
        return wrong(option + ": there is no folder '" + folder.string() + "'; create it first");
    if (std::filesystem::is_directory(output)) return wrong(option + ": '" + output + "' is a folder");
    return {};
}

Expected<void> check_outputs(const RenderOptions& options) {
    if (options.outputs.empty() && !options.coverage && !options.detach)
        return wrong("no output file: add -o FILE.exr or -o FILE.png");
    for (const std::string& output : options.outputs) {
        if (!picture_format(output)) {
            return wrong("-o: '" + output +
                         "' has no supported picture format; end it with .exr, .png or .jpg");
        }
        if (auto fine = check_place("-o", output); !fine) return fine;
    }
    return {};
}

Expected<EmbeddedSettings> embedded_settings(const RenderOptions& options) {
    EmbeddedSettings settings{.backend = options.backend.value_or(backend_names().front())};
    const auto names = backend_names();
    if (std::find(names.begin(), names.end(), settings.backend) == names.end()) {
        const auto near = nearest(settings.backend, names);
        return wrong("--backend: unknown back-end '" + settings.backend + "'" +
                     (near ? "; did you mean '" + *near + "'?" : "; see tessera doctor"));
    }
    const std::uint64_t nodes = options.nodes.value_or(1), threads = options.threads.value_or(0);
    if (nodes == 0 || nodes > MaxNodes) return wrong("--nodes: between 1 and 64");
    if (threads > MaxThreads) return wrong("--threads: at most 1024; 0 = all cores");
    settings.nodes = static_cast<std::uint32_t>(nodes);
    settings.threads = static_cast<std::uint32_t>(threads);
    if (options.reproducible) settings.isa = "avx2";
    settings.device = options.device.value_or("");
    settings.cache = options.cache.value_or("");
    const auto fine = backend::check_device(backend::find_backend(settings.backend), settings.device);
    if (!fine) return tl::unexpected(fine.error());
    return settings;
}

Expected<void> set_amount(const RenderOptions& options, session::ViewRequest& job) {
    constexpr std::uint64_t MostSamples = 65536;  // of a pixel, unless --spp says otherwise
    if (options.noise) {
        if (!(*options.noise > 0.0 && *options.noise <= 1.0)) return wrong("--noise: above 0, up to 1");
        job.stop.noise = *options.noise;
    }
    if (options.error) {
        if (options.noise) return wrong("--noise and --error exclude each other: leave one out");
        if (!(*options.error > 0.0 && *options.error <= 1.0)) return wrong("--error: above 0, up to 1");
        job.stop.error = *options.error;
    }
    const bool has_goal = job.stop.has_goal();
    // Without a noise or error, --time is only an upper bound of --spp.
    job.stop.uniform = options.adaptive == "off" || (options.spp && !has_goal);
    if (options.time) {
        const auto limit = parse_duration(*options.time);
        if (!limit) return wrong(std::string("--time: ") + limit.error().what());
        job.stop.time_limit = *limit;
        job.stop.spp = options.spp.value_or(has_goal ? MostSamples : MaxSpp);
    } else {
        job.stop.spp = options.spp.value_or(has_goal ? MostSamples : job.stop.spp);
    }
    if (job.stop.spp == 0 || job.stop.spp > MaxSpp) return wrong("--spp: between 1 and 2^31");
    return {};
}

Expected<void> set_sequence(const RenderOptions& options, RenderPlan& plan) {
    if (!options.frames) {
        if (options.fps || options.skip_existing)
            return wrong("--fps and --skip-existing are for sequences; add --frames A:B");
        if (options.view.animation && !options.view.at)
            return wrong("--animation needs a time: add --at SECONDS, or --frames A:B");
        if (options.view.shutter && !options.view.at)
            return wrong("--shutter needs an opening time: add --at SECONDS, or --frames A:B");
        return {};
    }
    if (options.view.at) return wrong("--at and --frames exclude each other");
    const auto frames = parse_frames(*options.frames);
    if (!frames) return wrong(std::string("--frames: ") + frames.error().what());
    Sequence sequence{.frames = *frames, .skip_existing = options.skip_existing};
    sequence.fps = options.fps.value_or(sequence.fps);
    if (!(sequence.fps > 0.0 && sequence.fps <= 1e6)) return wrong("--fps: above 0, up to 1e6");
    for (const std::string& output : options.outputs) {
        if (frame_name(output, 0)) continue;
        return wrong("-o: '" + output +
                     "' has no placeholder for the frame number; write it like out.%04d.exr");
    }
    plan.sequence = sequence;
    plan.view.import.motion = import::Motion::Sequence;
    plan.view.import.at = sequence.seconds(frames->first);
    return {};
}

Expected<void> check_noise_map(const RenderOptions& options) {
    if (!options.noise_map) return {};
    if (picture_format(*options.noise_map) != PictureFormat::Png)
        return wrong("--noise-map: '" + *options.noise_map + "' does not end with .png");
    if (options.frames)
        return wrong("--noise-map and --frames exclude each other: look at the layer 'noise' of EXR files");
    if (options.detach)
        return wrong("--noise-map and --detach exclude each other: store an EXR, which has a layer 'noise'");
    return check_place("--noise-map", *options.noise_map);
}

// Channels (AOVs) are requested only if an EXR is written, or if tev shows them.
bool any_exr(const std::vector<std::string>& outputs) {
    return std::any_of(outputs.begin(), outputs.end(), [](const std::string& output) {
        return picture_format(output) == PictureFormat::Exr;
    });
}

frame::ChannelSet channels_for(const RenderOptions& options) {
    using enum frame::Channel;
    if (options.save_statistics) {
        auto all = frame::ChannelSet::all();
        all.erase(Color);  // derived from Radiance
        return all;
    }
    if (any_exr(options.outputs) || options.tev)
        return {Radiance, LowVariance, HighVariance, Albedo, Normal, Depth, ObjectIndex, BlockVariance};
    if (options.noise_map) return {Radiance, BlockVariance};
    return {Radiance};
}

// A single PNG or JPEG is encoded by the master, within the time limit; otherwise the client receives pixel values.
Expected<void> set_filter(const RenderOptions& options, session::ViewRequest& job) {
    if (options.save_statistics && !any_exr(options.outputs)) {
        return wrong("--save-statistics needs an EXR output: add -o FILE.exr");
    }
    const auto filter = parse_options(options.filter);
    if (!filter) return tl::unexpected(filter.error());
    job.view.filter = *filter;
    if (filter->empty()) return {};
    if (options.error) {
        if (auto fine = check_error_estimate(*filter); !fine) return fine;
    }
    if (options.reproducible) {
        if (auto fine = check_reproducible(*filter); !fine) return fine;
    }
    if (!options.master) {  // otherwise the master answers for its machine
        if (auto fine = check_available(*filter); !fine) return fine;
    }
    if (options.detach) return {};  // see set_detached()
    job.film = any_exr(options.outputs) || options.noise_map || options.tev;
    const PictureFormat format = *picture_format(options.outputs.front());
    job.picture = options.outputs.size() > 1 || job.film ? session::PictureEncoding::Planes
                  : format == PictureFormat::Png         ? session::PictureEncoding::Png
                                                         : session::PictureEncoding::Jpeg;
    if (job.stop.time_limit > Duration::zero()) {
        job.stop.budget = job.stop.time_limit;
        job.stop.adapts_size = !job.film;
    }
    return {};
}

// The master encodes and keeps the picture, in the format of the output's extension.
Expected<void> set_detached(const RenderOptions& options, RenderPlan& plan) {
    plan.job.name = options.name;
    if (!options.detach) return {};
    if (options.name.empty()) return wrong("--detach: a job needs a name; add --name NAME");
    if (!options.master) return wrong("--detach needs a running cluster: add --master");
    if (options.frames) return wrong("--detach and --frames exclude each other");
    if (options.save_statistics) return wrong("--detach and --save-statistics exclude each other");
    if (options.json) return wrong("--detach and --json exclude each other; see tessera jobs --json");
    if (options.tev) return wrong("--detach and --tev exclude each other: wait for the picture");
    if (options.outputs.size() > 1)
        return wrong("--detach stores a single picture: give one -o, or none for a PNG");
    session::ViewRequest& job = plan.job;
    job.detached = true;
    job.film = false;
    job.frames = session::Frames::Last;
    if (!options.wait_nodes) job.wait_limit = Duration::zero();  // no user is present to start nodes
    const auto format = options.outputs.empty() ? std::nullopt : picture_format(options.outputs.front());
    job.picture = format == PictureFormat::Exr    ? session::PictureEncoding::Exr
                  : format == PictureFormat::Jpeg ? session::PictureEncoding::Jpeg
                                                  : session::PictureEncoding::Png;
    return {};
}

Expected<void> set_continued(const RenderOptions& options, RenderPlan& plan) {
    if (!options.continued) return {};
    if (options.frames) return wrong("--continue and --frames exclude each other: a film is one picture");
    if (options.detach) return wrong("--continue and --detach exclude each other: wait for the picture");
    if (!options.spp && !options.noise && !options.error && !options.time)
        return wrong("--continue: until when? Add --spp, --noise, --error or --time");
    plan.continued = options.continued;
    plan.given = options.view;
    plan.job.stop.adapts_size = false;
    return {};
}

Expected<void> set_tev(const RenderOptions& options, RenderPlan& plan) {
    plan.tev = options.tev;
    if (!options.tev) return {};
    if (auto fine = tev::check_address(*options.tev); !fine)
        return wrong(std::string("--tev: ") + fine.error().what());
    return {};
}

// Renders a larger picture with one pixel per sample; the usual size limits apply.
Expected<void> set_coverage(const RenderOptions& options, RenderPlan& plan) {
    constexpr std::uint64_t MaxSamples = 4096, DefaultSamples = 16, MaxEdge = 65536;
    constexpr std::uint64_t MaxPixels = std::uint64_t{1} << 28;  // limit of a master per view
    const std::uint64_t samples = options.spp.value_or(DefaultSamples);
    if (samples == 0 || samples > MaxSamples) return wrong("--spp: between 1 and 4096");
    plan.coverage = sample_grid(static_cast<std::uint32_t>(samples));
    const std::uint64_t width = std::uint64_t{plan.view.size.width} * plan.coverage->across;
    const std::uint64_t height = std::uint64_t{plan.view.size.height} * plan.coverage->down;
    if (width > MaxEdge || height > MaxEdge) {
        return wrong("--spp: each sample is a pixel of an internal picture, which would have " +
                     std::to_string(width) + "x" + std::to_string(height) +
                     " pixels; choose fewer samples, or a smaller --size");
    }
    spread(plan.view.view, *plan.coverage);
    if (plan.view.view.window.pixel_count() > MaxPixels)
        return wrong(
            "--spp: each sample is a pixel of an internal picture, which would have more than 2^28 pixels; "
            "choose fewer samples, a smaller --size, or a part with --crop");
    plan.view.view.renderer = view::Renderer::Coverage;
    plan.view.view.channels = {frame::Channel::ObjectIndex};
    if (!plan.outputs.empty()) plan.view.view.channels.insert(frame::Channel::Color);
    plan.job.stop.spp = 1;
    return {};
}

// How many samples.
void add_samples_to(cli::CommandLine& command, RenderOptions& options) {
    command.option("--spp", "samples per pixel (64)", options.spp);
    command.option("--time",
                   "time budget, as 800ms or 10s, spent on the pixels that need it; with --denoise it "
                   "includes denoising and encoding; with --spp, --noise or --error it is an upper bound",
                   options.time);
    command.option(
        "--noise",
        "samples where they are needed, until the unfiltered picture has this relative error (the root "
        "of relMSE, as of tessera compare), say 0.02; --spp (of any pixel) and --time are upper bounds",
        options.noise);
    command.option("--error",
                   "the same until the picture as it is written, denoised or not, has this relMSE by the "
                   "master's estimate, say 0.001: noise and bias of the denoiser",
                   options.error);
    command.choice("--adaptive",
                   "on: with --time, --noise or --error pixels get the samples that they need; off: all get "
                   "as many",
                   options.adaptive, {"on", "off"});
}

void add_cluster_to(cli::CommandLine& command, RenderOptions& options) {
    command.option("--backend", "back-end of the embedded nodes", options.backend);
    if (backend::has_device_choice()) {
        command.option("--device",
                       "device of the back-end: index or part of its name, as listed by tessera doctor "
                       "(default: the best)",
                       options.device);
    }
    command.option("--cache",
                   "cache folder for acceleration structures and compiled kernels, reused by later runs",
                   options.cache);
    command.option("--nodes", "number of embedded render nodes (1)", options.nodes);
    command.option("--threads", "total threads of all embedded nodes (default: all cores)", options.threads);
    command.option("--master", "render on a running cluster: tcp://host:port of its master", options.master);
    command.option("--keys", "keys for that cluster: a key folder or an exported key file", options.keys);
    command.option("--user", "name of the key to use from a key folder", options.user);
    command.option("--wait-nodes", "wait until N nodes are ready, fail after a timeout: N[:seconds]",
                   options.wait_nodes);
    command.flag("--no-wait", "exit with 75 if the cluster is busy, instead of waiting", options.no_wait);
}

}  // namespace

void RenderOptions::add_coverage_to(cli::CommandLine& command) {
    coverage = true;
    view.size = "640x360";
    view.add_scene_to(command);
    command.option("-o,--output", "picture with one colour per object, .exr, .png or .jpg", outputs);
    command.option("--spp", "samples per pixel (16)", spp);
    add_cluster_to(command, *this);
    command.flag("--json", "print one JSON object", json);
    cli::add_log_options(command, log);
    command.examples({"tessera coverage room.glb", "tessera coverage room.glb --camera 1 --json -o seen.png",
                      "tessera coverage room.glb --master tcp://render-1:7420 --keys ~/.tessera"});
}

void RenderOptions::add_to(cli::CommandLine& command) {
    view.add_to(command);
    command.option("-o,--output", "picture to write, .exr, .png or .jpg; may be given several times",
                   outputs);
    add_samples_to(command, *this);
    command.option(
        "--noise-map",
        "also write a PNG of the noise of each pixel, from 0.01 (black) over 0.1 (red) to 1 (white)",
        noise_map);
    command.option("--tev",
                   "show the picture and its layers while they are rendered in the image viewer tev at HOST "
                   "or HOST:PORT (default port: 14158)",
                   tev);
    command.option(
        "--continue",
        "go on with the film of this EXR, written with --save-statistics: of the same scene, with the "
        "camera, size, seed and samples in it, until --spp, --noise, --error or --time",
        continued);
    command.option("--frames", "render frames A:B of the animation, each to its own -o out.%04d.exr", frames);
    command.option(
        "--fps",
        "frames per second (24): frame K is rendered at K / fps seconds with seed S+K, where S is --seed",
        fps);
    command.flag("--skip-existing", "skip frames whose output files exist", skip_existing);
    filter.add_to(command);
    display.add_to(command);
    command.flag("--save-statistics", "store all film channels in the EXR, for tessera filter and --continue",
                 save_statistics);
    command.choice("--policy", "how a frame is divided into work units", policy,
                   {"tiled", "cooperative", "mixed"});
    command.flag("--reproducible",
                 "bit-identical results for any number of nodes: nodes of one kind (back-end, build, CPU "
                 "vendor), pinned to AVX2",
                 reproducible);
    add_cluster_to(command, *this);
    command.option("--name", "name of the view, as for tessera set-filter --view NAME", name);
    command.flag("--detach",
                 "exit once the cluster has the scene; tessera jobs shows the progress, tessera fetch NAME "
                 "downloads the picture",
                 detach);
    command.flag("--json", "print one JSON object with all measurements", json);
    cli::add_log_options(command, log);
    command.examples(
        {"tessera render room.glb -o room.exr -o room.png --spp 256",
         "tessera render room.glb -o room.png --spp 8 --denoise",
         "tessera render still.glb --env studio.exr -o still.png --time 800ms --denoise",
         "tessera render room.glb -o room.png --noise 0.02 --time 5min",
         "tessera render room.glb -o room.png --denoise --error 0.002",
         "tessera render room.glb --continue film.exr -o film.exr --save-statistics --spp 256",
         "tessera render robot.glb --at 1.5 --animation walk -o robot.exr",
         "tessera render robot.glb --frames 0:47 --fps 24 -o robot.%04d.exr",
         "tessera render room.glb -o room.exr --nodes 2 --policy cooperative --json",
         "tessera render room.glb -o room.exr --master tcp://render-1:7420 --keys ~/.tessera",
         "tessera render room.glb --spp 4096 --name night --detach --master tcp://render-1:7420"});
}

Expected<RenderPlan> parse_options(const RenderOptions& options) {
    auto view = parse_options(options.view);
    if (!view) return tl::unexpected(view.error());
    RenderPlan plan;
    plan.view = *view;
    plan.outputs = options.outputs;
    plan.job.film = true;
    plan.job.wait_limit = std::chrono::seconds(60);
    if (auto fine = check_outputs(options); !fine) return tl::unexpected(fine.error());
    if (auto fine = check_noise_map(options); !fine) return tl::unexpected(fine.error());
    plan.noise_map = options.noise_map;
    if (auto fine = set_tev(options, plan); !fine) return tl::unexpected(fine.error());
    if (auto fine = set_sequence(options, plan); !fine) return tl::unexpected(fine.error());
    auto embedded = embedded_settings(options);
    if (!embedded) return tl::unexpected(embedded.error());
    plan.embedded = *embedded;
    plan.job.min_nodes = plan.embedded.nodes;
    if (options.master) {
        if (options.backend || options.device || options.cache || options.nodes || options.threads) {
            return wrong(
                "--backend, --device, --cache, --nodes and --threads configure the embedded cluster; with "
                "--master, set them on the nodes");
        }
        plan.address = {*options.master, options.keys.value_or(""), options.user};
        plan.job.min_nodes = 1;
        if (options.wait_nodes) {
            const auto wait = parse_node_wait(*options.wait_nodes);
            if (!wait) return wrong(std::string("--wait-nodes: ") + wait.error().what());
            plan.job.min_nodes = wait->nodes;
            plan.job.wait_limit = wait->limit;
        }
    } else if (options.keys || options.wait_nodes) {
        return wrong("--keys and --wait-nodes need a running cluster: add --master");
    } else if (view->view.renderer == view::Renderer::Raster &&
               !backend::find_backend(plan.embedded.backend).chooses_device) {
        // No other node can join an embedded cluster. The node checks whether the device supports rasterisation.
        return wrong("--renderer raster: " + plan.embedded.backend +
                     " does not support rasterisation; add --backend vulkan");
    }
    if (options.no_wait) plan.when_busy = client::WhenBusy::GiveUp;
    if (options.coverage) {
        if (auto fine = set_coverage(options, plan); !fine) return tl::unexpected(fine.error());
        return plan;
    }
    if (auto fine = set_amount(options, plan.job); !fine) return tl::unexpected(fine.error());
    plan.job.policy = options.policy == "tiled"         ? session::Policy::Tiled
                      : options.policy == "cooperative" ? session::Policy::Cooperative
                                                        : session::Policy::Mixed;
    plan.job.reproducible = options.reproducible;
    if (auto fine = set_filter(options, plan.job); !fine) return tl::unexpected(fine.error());
    if (auto fine = set_detached(options, plan); !fine) return tl::unexpected(fine.error());
    const auto display = parse_options(options.display);
    if (!display) return tl::unexpected(display.error());
    plan.job.display_transform = display->transform;
    plan.custom_view = display->custom;
    if (const auto unused = unused_display_options(options.display, options.outputs))
        std::cerr << "tessera render: " << *unused << "\n";
    if (plan.custom_view) {
        if (options.detach)
            return wrong("--ocio: the master encodes the picture of a job: fetch an EXR and convert that");
        if (!plan.job.view.filter.empty()) plan.job.picture = session::PictureEncoding::Planes;
    }
    plan.view.view.filter = plan.job.view.filter;
    plan.view.view.channels = plan.view.view.channels | channels_for(options);
    if (options.save_statistics) plan.statistics = picture::Statistics::Include;
    plan.job.film_state = options.save_statistics;
    if (auto fine = set_continued(options, plan); !fine) return tl::unexpected(fine.error());
    return plan;
}

}  // namespace tessera::tools
