// Bare traversal beside Embree: bvh_bench [--device NAME|INDEX] [SCENE.glb | TRIANGLES ...]. On a CPU device
// the figures are Mray per second of processor time, so that other work on the machine does not count; on a
// GPU Mray per second of the wall's clock, still beside Embree on one core.
#include <chrono>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <functional>
#include <glm/geometric.hpp>
#include <string>

#include "client/import/import.h"
#include "mediator/backend/tables/tables.h"
#include "mediator/shading/points.h"
#include "mediator/shading/sampling.h"
#include "mediator/shading/sobol.h"
#include "tests/bvh/traced_device.h"

namespace {

using namespace tessera;
using namespace tessera::vulkan;

constexpr std::uint32_t Size = 512, Repeats = 5;
constexpr float Near = shading::NearestHit;

struct Subject {
    std::string name;
    std::unique_ptr<TracedScene> scene;
    glm::dmat4 world_from_camera{1.0};
    double fov = 1.2;
};

Subject from_file(const std::string& path) {
    auto imported = import::import_scene(path, {});
    if (!imported) throw imported.error();
    scene::BlobStore blobs;
    for (const auto& blob : imported->blobs) blobs.insert(blob);
    scene::Scene scene;
    if (auto applied = scene.apply_entries(import::entries(*imported, import::RootEntry::Create)); !applied) {
        throw applied.error();
    }
    const auto lowered = backend::lower(scene);
    if (!lowered) throw lowered.error();
    std::vector<TestMesh> meshes;
    std::map<ObjectId, std::uint32_t> places;
    std::vector<TestInstance> instances;
    for (const backend::Instance& instance : lowered->instances) {
        const auto [place, added] = places.try_emplace(instance.geometry, meshes.size());
        if (added) {
            const auto* geometry = scene.find_as<scene::Geometry>(instance.geometry);
            const auto positions = blobs.find(geometry->positions.hash)->as<glm::vec3>();
            const auto triangles = blobs.find(geometry->indices.hash)->as<glm::uvec3>();
            meshes.push_back({{positions.begin(), positions.end()}, {triangles.begin(), triangles.end()}});
        }
        instances.push_back({place->second, glm::mat3(glm::dmat3(instance.world_from_object)),
                             glm::vec3(instance.world_from_object[3])});
    }
    const auto& camera = imported->cameras.at(0);
    return {path.substr(path.rfind('/') + 1), std::make_unique<TracedScene>(std::move(meshes), instances),
            camera.world_from_camera, camera.vertical_fov};
}

// Bumpy balls in a box that is open to the camera.
Subject generated(std::uint32_t triangles) {
    const std::uint32_t balls = triangles > 500'000 ? 50 : 20;
    const auto rows = static_cast<std::uint32_t>(std::sqrt(triangles / balls / 4.0) + 1.0);
    CounterRandom random(7);
    TestMesh all;
    const auto add = [&](const TestMesh& part) {
        const auto first = static_cast<std::uint32_t>(all.positions.size());
        all.positions.insert(all.positions.end(), part.positions.begin(), part.positions.end());
        for (const glm::uvec3& t : part.triangles) all.triangles.push_back(t + first);
    };
    for (std::uint32_t i = 0; i < balls; ++i) {
        add(ball(rows, 0.4f + 1.6f * static_cast<float>(random.uniform()),
                 random_point(random, -7.0f, 7.0f)));
    }
    for (int axis = 0; axis < 3; ++axis) {
        for (const float side : {-10.0f, 10.0f}) {
            if (axis == 2 && side > 0.0f) continue;
            glm::vec3 corner(-10.0f), u(0.0f), v(0.0f);
            corner[axis] = side;
            u[(axis + 1) % 3] = v[(axis + 2) % 3] = 20.0f;
            TestMesh wall;
            wall.positions = {corner, corner + u, corner + u + v, corner + v};
            wall.triangles = {{0, 1, 2}, {0, 2, 3}};
            add(wall);
        }
    }
    glm::dmat4 camera(1.0);
    camera[3] = glm::dvec4(0.0, 0.0, 20.0, 1.0);
    std::string name = std::to_string(all.triangles.size()) + " triangles";
    return {name, std::make_unique<TracedScene>(std::vector<TestMesh>{all}, std::vector<TestInstance>{{}}),
            camera, 1.35};
}

std::vector<TestRay> camera_rays(const Subject& subject) {
    std::vector<TestRay> rays;
    const double height = std::tan(0.5 * subject.fov);
    for (std::uint32_t i = 0; i < Size * Size; ++i) {  // in tiles of 8 x 8
        const std::uint32_t tile = i / 64, x = tile % (Size / 8) * 8 + i % 8,
                            y = tile / (Size / 8) * 8 + i % 64 / 8;
        const glm::dvec3 local((2.0 * (x + 0.5) / Size - 1.0) * height,
                               (1.0 - 2.0 * (y + 0.5) / Size) * height, -1.0);
        rays.push_back({glm::vec3(subject.world_from_camera[3]),
                        glm::vec3(glm::normalize(glm::dmat3(subject.world_from_camera) * local)), Near});
    }
    return rays;
}

// From what the camera sees: diffuse bounces, and segments to points before other places that it sees.
void scatter(const TracedScene& scene, const std::vector<TestRay>& seen, std::vector<TestRay>& bounces,
             std::vector<TestRay>& shadows) {
    struct Vertex {
        shading::PointWithError point;
        glm::vec3 normal;
    };
    std::vector<Vertex> vertices;
    for (const TestRay& ray : seen) {
        const shading::Hit hit = scene.ask_embree(ray);
        if (hit.instance == shading::NoInstance) continue;
        const TestInstance& placed = scene.instance(hit.instance);
        const TestMesh& mesh = scene.mesh(placed.mesh);
        shading::Instance instance{};
        instance.linear = placed.linear;
        instance.translation = placed.translation;
        shading::Mesh arrays{};
        arrays.positions = {mesh.positions.data()};
        const glm::uvec3& t = mesh.triangles[hit.triangle];
        glm::vec3 normal =
            glm::normalize(glm::cross(placed.linear * (mesh.positions[t.y] - mesh.positions[t.x]),
                                      placed.linear * (mesh.positions[t.z] - mesh.positions[t.x])));
        if (glm::dot(normal, ray.direction) > 0.0f) normal = -normal;
        vertices.push_back(
            {shading::point_on(instance, shading::triangle_of(arrays, t), hit.barycentric), normal});
    }
    CounterRandom random(9);
    for (const auto& [point, normal] : vertices) {
        const glm::vec2 u(random.uniform(), random.uniform());
        const glm::vec3 out = shading::frame_around(normal) * shading::sample_cosine_hemisphere(u);
        bounces.push_back({shading::leave_surface(point.position, point.error, normal, out), out, Near});
        const glm::vec3 target =
            glm::mix(vertices[random.below(vertices.size())].point.position, seen[0].origin, 0.1f);
        const glm::vec3 way = target - point.position;
        shadows.push_back(
            {shading::leave_surface(point.position, point.error, normal, way), way, Near, 0.999f});
    }
}

double processor_seconds() {
    timespec time;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

double wall_seconds() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double best_of(const std::function<double()>& clock, const std::function<void()>& work) {
    work();  // the first one compiles
    double best = INFINITY;
    for (std::uint32_t i = 0; i < Repeats; ++i) {
        const double start = clock();
        work();
        best = std::min(best, clock() - start);
    }
    return best;
}

void measure(Device& device, const Subject& subject, const char* kind, const std::vector<TestRay>& rays,
             std::uint32_t question) {
    const bool any = question == shading::BvhAny;
    std::uint64_t sum = 0;
    const double embree = best_of(processor_seconds, [&] {
        for (const TestRay& ray : rays) {
            sum += any ? subject.scene->embree_occluded(ray) : subject.scene->ask_embree(ray).triangle;
        }
    });
    const auto clock = device.info().kind == DeviceKind::Cpu ? processor_seconds : wall_seconds;
    const auto rate = [&](double seconds) { return 1e-6 * static_cast<double>(rays.size()) / seconds; };
    std::printf("%-20s %-8s %8.2f", subject.name.c_str(), kind, rate(embree));
    double plain = 0.0;
    for (const Traversal traversal : {Traversal::Plain, Traversal::Address, Traversal::Texels}) {
        const TracedDevice traced(device, *subject.scene, rays, traversal, question);
        const double seconds = best_of(clock, [&] { traced.run(); });
        if (traversal == Traversal::Plain) plain = seconds;
        std::printf("  %8.2f %5.2f x E %5.2f x P", rate(seconds), embree / seconds, plain / seconds);
    }
    std::printf("%s\n", sum == 1 ? " " : "");
    std::fflush(stdout);
}

void measure(Device& device, const Subject& subject) {
    const std::vector<TestRay> primary = camera_rays(subject);
    std::vector<TestRay> bounces, shadows;
    scatter(*subject.scene, primary, bounces, shadows);
    measure(device, subject, "primary", primary, shading::BvhClosest);
    measure(device, subject, "bounce", bounces, shading::BvhClosest);
    measure(device, subject, "shadow", shadows, shading::BvhAny);
}

}  // namespace

int main(int count, char** words) {
    std::string wanted;
    std::vector<std::string> subjects;
    for (int i = 1; i < count; ++i) {
        if (std::strcmp(words[i], "--device") == 0 && i + 1 < count) {
            wanted = words[++i];
        } else {
            subjects.emplace_back(words[i]);
        }
    }
    if (subjects.empty()) {
        for (const char* file : {"room-1", "studio-1", "still"}) {
            subjects.push_back(std::string(TESSERA_SCENES) + "/" + file + ".glb");
        }
        subjects.insert(subjects.end(), {"100000", "1000000"});
    }
    try {
        const Instance instance;
        const auto devices = list_devices(instance);
        Device device(instance, choose_device(devices, wanted));
        std::printf(
            "%s; E = Embree's rtcIntersect1 or rtcOccluded1 on one core, P = plain trees of two children\n",
            device.info().name.c_str());
        std::printf("%-20s %-8s %8s  %-27s  %-27s  %-27s\n", "Mray/s", "", "Embree", "plain, by address",
                    "8-wide, by address", "8-wide, as texels");
        for (const std::string& subject : subjects) {
            const bool file = subject.find('.') != std::string::npos;
            measure(device,
                    file ? from_file(subject) : generated(static_cast<std::uint32_t>(std::stoul(subject))));
        }
    } catch (const Error& error) {
        std::fprintf(stderr, "bvh_bench: %s\n", error.what());
        return 1;
    }
}
