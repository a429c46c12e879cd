#pragma once

#include <optional>
#include <string>
#include <vector>

#include "client/session.h"
#include "client/tools/coverage.h"
#include "client/tools/display_transform_options.h"
#include "client/tools/embedded_cluster.h"
#include "client/tools/filter_options.h"
#include "client/tools/view_options.h"
#include "mediator/picture/film_exr.h"
#include "mediator/program/log.h"

namespace tessera::tools {

// The options of `tessera render` and `tessera coverage`, as typed.
struct RenderOptions {
    ViewOptions view;
    DisplayTransformOptions display;
    std::vector<std::string> outputs;
    std::optional<std::uint64_t> spp, nodes, threads;
    std::optional<std::string> time, backend, device, cache, master, keys, wait_nodes, frames;
    std::optional<double> fps, noise, error;
    std::optional<std::string> noise_map, continued, tev;
    std::string user = "editor";
    std::string policy = "mixed", adaptive = "on";
    FilterOption filter;
    std::string name;
    bool detach = false;
    bool reproducible = false, no_wait = false, json = false, save_statistics = false, skip_existing = false;
    cli::LogSettings log{.program = "tessera"};

    bool coverage = false;  // of objects, instead of light (client/tools/coverage.h)

    void add_to(cli::CommandLine& command);
    void add_coverage_to(cli::CommandLine& command);
};

// Frames of an animation: frame i shows the scene at i / fps seconds.
struct Sequence {
    FrameRange frames;
    double fps = 24.0;
    bool skip_existing = false;

    double seconds(std::uint32_t frame) const { return static_cast<double>(frame) / fps; }
};

// The validated options.
struct RenderPlan {
    ViewPlan view;
    session::ViewRequest job;              // view with channels, without camera
    std::vector<std::string> outputs;      // of a sequence: patterns for frame_name
    std::optional<std::string> noise_map;  // a picture of the noise, as write_noise_map() does
    std::optional<std::string> tev;        // where that viewer listens
    std::optional<std::string> continued;  // a film file that the picture goes on with
    ViewOptions given;                     // the options of the view as typed
    std::optional<Sequence> sequence;
    std::optional<client::Address> address;  // none: embedded cluster
    EmbeddedSettings embedded;
    client::WhenBusy when_busy = client::WhenBusy::Queue;
    picture::Statistics statistics = picture::Statistics::Omit;
    std::optional<SampleGrid> coverage;              // the view is enlarged by it
    std::optional<picture::CustomView> custom_view;  // of --ocio
};
// InvalidInput: wrong options; Unavailable: right ones, of a filter that this machine cannot run.
Expected<RenderPlan> parse_options(const RenderOptions& options);

}  // namespace tessera::tools
