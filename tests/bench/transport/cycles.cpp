#include "tests/bench/transport/cycles.h"

#include <stdlib.h>
#include <unistd.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "client/export/export.h"
#include "client/tools/child_process.h"
#include "mediator/picture/atomic_file.h"
#include "mediator/picture/exr_reader.h"
#include "mediator/scene/fields.h"
#include "tests/bench/transport/cycles_script.h"

namespace tessera::tools::bench {

namespace {

namespace fs = std::filesystem;

class TemporaryFolder {
  public:
    TemporaryFolder() {
        std::string pattern = (fs::temp_directory_path() / "tessera-cycles-XXXXXX").string();
        if (::mkdtemp(pattern.data()) == nullptr)
            throw Error(ErrorCode::Io, "cannot create a folder in " + fs::temp_directory_path().string() +
                                           ": is it writable?");
        path_ = pattern;
    }
    ~TemporaryFolder() {
        std::error_code ignored;
        fs::remove_all(path_, ignored);
    }
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;
    const fs::path& path() const { return path_; }
    fs::path operator/(const std::string& name) const { return path_ / name; }

  private:
    fs::path path_;
};

std::vector<std::uint64_t> counts(const std::vector<std::uint64_t>& all) {
    std::vector<std::uint64_t> chosen{all.front()};
    if (all.size() > 2) chosen.push_back(all[all.size() / 2]);
    if (all.size() > 1) chosen.push_back(all.back());
    return chosen;
}

// Built-in scenes have their camera apart.
scene::Scene with_camera(const BenchScene& bench) {
    scene::Scene scene = bench.content;
    const ObjectId camera = {std::prev(scene.objects().end())->first.value + 1}, transform{camera.value + 1};
    scene::Root root = *scene.find_as<scene::Root>(scene::RootId);
    root.children.push_back(transform);
    const std::vector<scene::Entry> entries{
        scene::Create{camera, bench.camera.camera},
        scene::Create{transform,
                      scene::Transform{
                          .name = "camera", .matrix = bench.camera.world_from_camera, .children = {camera}}},
        scene::Update{scene::RootId, scene::Fields<scene::Root>(&scene::Root::children).bits(), root}};
    if (auto applied = scene.apply_entries(entries); !applied) throw applied.error();
    return scene;
}

glm::vec3 background_color(const scene::Scene& scene) {
    const auto* root = scene.find_as<scene::Root>(scene::RootId);
    const auto* background = root == nullptr ? nullptr : scene.find_as<scene::Background>(root->background);
    return background == nullptr ? glm::vec3(0.0f) : background->color * background->strength;
}

Expected<fs::path> gltf_file(const BenchScene& scene, const fs::path& folder) {
    if (!scene.file.empty()) return fs::absolute(scene.file);
    scene::BlobStore blobs;
    for (const scene::BlobPtr& blob : scene.blobs) blobs.insert(blob);
    const fs::path file = folder / "scene.glb";
    if (auto written = exporting::write_glb(with_camera(scene), blobs, file); !written)
        return tl::unexpected(written.error());
    return file;
}

std::string last_line(const std::string& text) {
    const std::size_t end = text.find_last_not_of(" \n");
    if (end == std::string::npos) return "it printed nothing";
    const std::size_t line = text.rfind('\n', end);
    return text.substr(line == std::string::npos ? 0 : line + 1,
                       end + 1 - (line == std::string::npos ? 0 : line + 1));
}

// One picture to render.
struct Job {
    std::uint64_t spp = 0, seed = 0;
    fs::path file;
};

struct Times {
    double import = 0.0;
    std::vector<double> pictures;  // seconds of each
};

// Renders all pictures in one process of Blender.
Expected<Times> render(const BenchScene& scene, const TransportPlan& plan, const std::vector<Job>& jobs,
                       const fs::path& folder, const std::stop_token& stop) {
    const auto file = gltf_file(scene, folder);
    if (!file) return tl::unexpected(file.error());
    const glm::vec3 background = background_color(scene.content);
    nlohmann::json pictures = nlohmann::json::array();
    for (const Job& job : jobs) pictures.push_back({job.spp, job.seed, job.file.string()});
    const fs::path job = folder / "job.json", results = folder / "results.json",
                   script = folder / "render.py";
    picture::write_atomically(
        job.string(),
        nlohmann::json{
            {"scene", file->string()},
            {"environment", scene.environment.empty() ? "" : fs::absolute(scene.environment).string()},
            {"background", {background.x, background.y, background.z}},
            {"width", plan.size.width},
            {"height", plan.size.height},
            {"threads", plan.jobs},
            {"bounces", scene.max_bounces},
            {"pictures", pictures},
            {"results", results.string()}}
            .dump());
    picture::write_atomically(script.string(), cycles_script());
    ChildProcess blender(folder, "blender", "/usr/bin/env",
                         {"blender", "-b", "--factory-startup", "--python-exit-code", "1", "-P",
                          script.string(), "--", job.string()});
    std::optional<int> code;
    while (!(code = blender.wait(std::chrono::milliseconds(100)))) {
        if (stop.stop_requested()) return failure(ErrorCode::Refused, "stopped");
    }
    if (*code != 0)
        return failure(ErrorCode::Internal,
                       "blender failed with exit code " + std::to_string(*code) + ": " +
                           last_line(blender.err().empty() ? blender.out() : blender.err()));
    const auto times = nlohmann::json::parse(std::ifstream(results));
    return Times{.import = times["import_seconds"].get<double>(),
                 .pictures = times["pictures"].get<std::vector<double>>()};
}

// Where the references of Cycles are kept for the next run.
fs::path reference_file(const BenchScene& scene, const TransportPlan& plan, std::uint64_t seed) {
    return plan.references /
           ("cycles-" + scene.name + "-" + std::to_string(plan.size.width) + "x" +
            std::to_string(plan.size.height) + "-" + std::to_string(plan.reference_spp) + "spp-" +
            std::to_string(seed) + "-" + to_hex(scene.content.state_hash()).substr(0, 8) + ".exr");
}

}  // namespace

bool has_cycles() {
    const char* const path = std::getenv("PATH");
    std::string folders = path == nullptr ? "" : path;
    std::ranges::replace(folders, ':', ',');
    for (const std::string& folder : split_list(folders)) {
        if (::access((fs::path(folder) / "blender").c_str(), X_OK) == 0) return true;
    }
    return false;
}

Expected<TransportCurve> measure_cycles(const BenchScene& scene, const TransportPlan& plan,
                                        const BenchProgress& progress, const std::stop_token& stop) {
    const TemporaryFolder folder;
    const std::vector<std::uint64_t> spp = counts(plan.spp);
    std::vector<Job> jobs{{1, 1, folder / "first.exr"}};
    for (const std::uint64_t count : spp) {
        for (std::uint64_t seed = 1; seed <= plan.seeds; ++seed)
            jobs.push_back(
                {count, seed, folder / (std::to_string(count) + "-" + std::to_string(seed) + ".exr")});
    }
    std::vector<std::pair<fs::path, fs::path>> rendered;  // references, and where they are kept
    for (const std::uint64_t seed : ReferenceSeeds) {
        const fs::path kept = reference_file(scene, plan, seed);
        if (fs::exists(kept)) continue;
        rendered.emplace_back(folder / ("reference-" + std::to_string(seed) + ".exr"), kept);
        jobs.push_back({plan.reference_spp, seed, rendered.back().first});
    }
    progress.say(scene.name + ", cycles: " + std::to_string(jobs.size()) + " pictures");
    const auto times = render(scene, plan, jobs, folder.path(), stop);
    if (!times) return tl::unexpected(times.error());
    for (const auto& [from, to] : rendered) fs::copy_file(from, to, fs::copy_options::overwrite_existing);
    const ReferencePair truth(
        picture::read_exr(reference_file(scene, plan, ReferenceSeeds[0]).string()).image,
        picture::read_exr(reference_file(scene, plan, ReferenceSeeds[1]).string()).image);
    TransportCurve curve{.renderer = "cycles", .points = {}};
    curve.first_picture_seconds = times->import + times->pictures.front();
    std::size_t next = 1;
    for (const std::uint64_t count : spp) {
        TransportPoint point{.spp = count};
        for (std::uint64_t seed = 1; seed <= plan.seeds; ++seed, ++next)
            add_picture(picture::read_exr(jobs[next].file.string()).image, truth, times->pictures[next], plan,
                        point);
        curve.points.push_back(point);
    }
    return curve;
}

}  // namespace tessera::tools::bench
