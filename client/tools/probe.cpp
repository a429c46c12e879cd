#include "client/tools/probe.h"

#include <algorithm>
#include <glm/vec3.hpp>
#include <iostream>
#include <memory>

#include "client/tools/view_options.h"
#include "master/scene/scene_authority.h"
#include "mediator/backend/catalog.h"

namespace tessera::tools {

namespace {

constexpr const char* ProbeName = "probe";
constexpr SessionId OnlySession{1};

struct ProbeOptions {
    ViewOptions view;
    std::string pixel;
    std::uint64_t sample = 0;
    std::optional<std::string> backend;
    std::string device;
    bool reproducible = false;
};

// The scene as in a cluster: same ids and render origin, hence bit-identical results.
scene::ChangeList authority_snapshot(ViewPlan& plan, const std::shared_ptr<scene::BlobStore>& blobs,
                                     import::CameraInfo& camera) {
    master::SceneAuthority authority(1, blobs);
    plan.import.first_id = ObjectId{authority.allocate_id_range(OnlySession).first};
    auto imported = import_scene(plan);
    if (!imported) throw imported.error();
    for (const scene::BlobPtr& blob : imported->blobs) blobs->insert(blob);
    const auto answer = authority.submit({.session = OnlySession,
                                          .sequence = 1,
                                          .base = authority.version(),
                                          .entries = entries(*imported, import::RootEntry::Update)});
    if (!answer.accepted) {
        throw Error(ErrorCode::InvalidInput,
                    answer.problems.empty() ? "the scene is not valid" : answer.problems[0]);
    }
    authority.publish();
    auto chosen = choose_camera(imported->cameras, plan.camera);
    if (!chosen) throw chosen.error();
    camera = *chosen;
    authority.follow_camera(glm::dvec3(camera.world_from_camera[3]));
    return authority.published().snapshot();
}

int run(const ProbeOptions& options) {
    auto plan = parse_options(options.view);
    if (!plan) return report_error(ProbeName, cli::ExitUsage, plan.error().what());
    const auto pixel = parse_pixel(options.pixel, plan->size);
    if (!pixel)
        return report_error(ProbeName, cli::ExitUsage, std::string("--pixel: ") + pixel.error().what());
    try {
        const auto blobs = std::make_shared<scene::BlobStore>();
        const backend::BackendEntry& entry =
            options.backend ? backend::find_backend(*options.backend) : backend::catalog().front();
        if (const auto fine = backend::check_device(entry, options.device); !fine) {
            return report_error(ProbeName, cli::ExitUsage, fine.error().what());
        }
        const auto backend =
            entry.make({.isa = options.reproducible ? "avx2" : "", .device = options.device, .blobs = blobs});
        import::CameraInfo camera;
        const scene::ChangeList scene = authority_snapshot(*plan, blobs, camera);
        {
            const auto edit = backend->begin_edit();
            if (auto applied = edit->apply(scene); !applied) throw applied.error();
            if (auto committed = edit->commit(); !committed) throw committed.error();
        }
        view::View view = view_from(*plan, camera);
        view.channels = backend->capabilities().channels;
        for (const std::string& line : backend->probe(view, pixel->x, pixel->y, options.sample)) {
            std::cout << line << "\n";
        }
        return 0;
    } catch (const Error& error) {
        return report_error(ProbeName, exit_code(error.code()), error.what());
    }
}

}  // namespace

Command probe_command(cli::CommandLine& program) {
    const auto options = std::make_shared<ProbeOptions>();
    cli::CommandLine& command =
        program.command(ProbeName, "Replay one sample of one pixel and print its path.");
    options->view.add_to(command);
    command.option("--pixel", "X,Y from the top left", options->pixel);
    command.option("--sample", "index of the sample, from 0", options->sample);
    command.option("--backend", "back-end to use", options->backend);
    if (backend::has_device_choice()) {
        command.option("--device", "device to use: index or part of its name", options->device);
    }
    command.flag("--reproducible", "as for frames rendered with --reproducible: pinned to AVX2",
                 options->reproducible);
    command.required("--pixel");
    command.examples({"tessera probe room.glb --pixel 320,180 --sample 7",
                      "tessera probe still.glb --env studio.exr --size 640x360 --pixel 10,20 --sample 0"});
    return {ProbeName, [options](std::string_view) { return run(*options); }};
}

}  // namespace tessera::tools
