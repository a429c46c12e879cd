// Cost of edits compared with the bare Embree operations:
//   tessera_update_bench
// A mesh of 100,000 triangles that deforms: refit over rebuild (target: 0.15). Moving one of 100,000
// instances: the whole edit over the bare commit of an Embree scene with the same instances (target: 1.2).
// One thread; medians of edits in turn.
#include <cmath>
#include <cstdio>
#include <glm/gtc/matrix_transform.hpp>

#include "tests/backend/scene_builder.h"
#include "tests/bench/micro/scene_fixture.h"

namespace tessera::embree {
namespace {

using scene::Geometry;

constexpr std::uint32_t Side = 224, Instances = 100000, Rounds = 21, Shapes = 4;
constexpr ObjectId MeshId{2}, SkyId{3};

template <class Work>
double milliseconds(const Work& work) {
    const double start = bench::cpu_seconds();
    work();
    return 1e3 * (bench::cpu_seconds() - start);
}

struct Stage {
    std::shared_ptr<scene::BlobStore> blobs = std::make_shared<scene::BlobStore>();
    DeviceHandle device = make_device({.threads = 1, .blobs = blobs});
    SceneAdapter world{device.get(), blobs};
    test::SceneBuilder builder;

    template <class T>
    scene::BlobRef blob(const std::vector<T>& values) {
        return scene::reference(*blobs->insert(std::as_bytes(std::span(values))));
    }
    void edit(const scene::ChangeList& list) {
        if (auto applied = world.apply(list); !applied) throw applied.error();
        if (auto committed = world.commit(); !committed) throw committed.error();
    }
    double timed(const scene::ChangeList& list) {
        return milliseconds([&] { edit(list); });
    }
};

// Waves on a square of Side x Side quads.
std::vector<glm::vec3> waves(double phase) {
    std::vector<glm::vec3> positions;
    for (std::uint32_t y = 0; y <= Side; ++y) {
        for (std::uint32_t x = 0; x <= Side; ++x) {
            const double u = double(x) / Side, v = double(y) / Side;
            positions.emplace_back(u, 0.1 * std::sin(9.0 * u + 5.0 * v + phase), v);
        }
    }
    return positions;
}

std::vector<std::uint32_t> quads() {
    std::vector<std::uint32_t> indices;
    for (std::uint32_t y = 0; y < Side; ++y) {
        for (std::uint32_t x = 0; x < Side; ++x) {
            const std::uint32_t a = y * (Side + 1) + x, b = a + Side + 1;
            indices.insert(indices.end(), {a, b, a + 1, a + 1, b, b + 1});
        }
    }
    return indices;
}

struct Waves : Stage {
    std::vector<scene::BlobRef> shapes;

    explicit Waves(scene::MotionHint hint) {
        for (std::uint32_t i = 0; i < Shapes; ++i) shapes.push_back(blob(waves(0.3 * i)));
        const Geometry mesh{.hint = hint, .indices = blob(quads()), .positions = shapes[0]};
        edit(builder.edit(
            {scene::Create{MeshId, mesh}, scene::Create{scene::RootId, scene::Root{.children = {MeshId}}}}));
    }
    double deform(std::uint32_t shape) {
        const Geometry mesh{.positions = shapes[shape]};
        return timed(
            builder.edit({test::SceneBuilder::update<Geometry>(MeshId, &Geometry::positions, mesh)}));
    }
};

void compare_refit() {
    Waves refitted(scene::MotionHint::Animated), rebuilt(scene::MotionHint::Unflagged);
    std::vector<double> refits, rebuilds, ratios;
    for (std::uint32_t i = 0; i < Rounds; ++i) {
        const std::uint32_t shape = (i + 1) % Shapes;
        refits.push_back(refitted.deform(shape));
        rebuilds.push_back(rebuilt.deform(shape));
        ratios.push_back(refits.back() / rebuilds.back());
    }
    std::printf("a mesh of %u triangles: refit %.2f ms, rebuild %.2f ms: x %.3f\n", 2 * Side * Side,
                bench::median(refits), bench::median(rebuilds), bench::median(ratios));
}

glm::dmat4 instance_transform(std::uint32_t i, double height) {
    return glm::translate(glm::dmat4(1.0), {double(i % 317), height + 0.01 * double(i % 7), double(i / 317)});
}

struct Crowd : Stage {
    Crowd() {
        Geometry mesh{.indices = blob(std::vector<std::uint32_t>{0, 1, 2, 0, 2, 3}),
                      .positions = blob(std::vector<glm::vec3>{{0, 0, 0}, {1, 0, 0}, {1, 0, 1}, {0, 0, 1}})};
        std::vector<scene::Entry> entries{scene::Create{MeshId, mesh}};
        scene::Root root{.background = SkyId};
        entries.emplace_back(scene::Create{SkyId, scene::Background{}});
        for (std::uint32_t i = 0; i < Instances; ++i) {
            root.children.push_back(ObjectId{10 + i});
            entries.emplace_back(
                scene::Create{ObjectId{10 + i}, test::transform(instance_transform(i, 0.0), {MeshId})});
        }
        entries.emplace_back(scene::Create{scene::RootId, root});
        edit(builder.edit(std::move(entries)));
    }
};

// The same instances with Embree alone.
class Bare {
  public:
    explicit Bare(const SceneAdapter& world, RTCDevice device)
        : mesh_(rtcNewScene(device)), top_(rtcNewScene(device)) {
        const GeometryHandle triangles(rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE));
        auto* corners = static_cast<glm::vec3*>(rtcSetNewGeometryBuffer(
            triangles.get(), RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(glm::vec3), 4));
        auto* indices = static_cast<glm::uvec3*>(rtcSetNewGeometryBuffer(
            triangles.get(), RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, sizeof(glm::uvec3), 2));
        corners[0] = {0, 0, 0}, corners[1] = {1, 0, 0}, corners[2] = {1, 0, 1}, corners[3] = {0, 0, 1};
        indices[0] = {0, 1, 2}, indices[1] = {0, 2, 3};
        rtcCommitGeometry(triangles.get());
        rtcAttachGeometry(mesh_.get(), triangles.get());
        rtcCommitScene(mesh_.get());
        rtcSetSceneFlags(top_.get(), RTC_SCENE_FLAG_ROBUST);
        for (std::uint32_t i = 0; i < world.tables().instances.size(); ++i) {
            const GeometryHandle instance(rtcNewGeometry(device, RTC_GEOMETRY_TYPE_INSTANCE));
            rtcSetGeometryInstancedScene(instance.get(), mesh_.get());
            rtcAttachGeometryByID(top_.get(), instance.get(), i);
            move(i, world.tables().instances[i].translation);
        }
        rtcCommitScene(top_.get());
    }
    double moved(std::uint32_t i, const glm::vec3& to) {
        move(i, to);
        return milliseconds([&] { rtcCommitScene(top_.get()); });
    }

  private:
    void move(std::uint32_t i, const glm::vec3& to) {
        const float columns[12] = {1, 0, 0, 0, 1, 0, 0, 0, 1, to.x, to.y, to.z};
        const RTCGeometry geometry = rtcGetGeometry(top_.get(), i);
        rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, columns);
        rtcCommitGeometry(geometry);
    }

    SceneHandle mesh_, top_;
};

void compare_instances() {
    Crowd crowd;
    Bare bare(crowd.world, crowd.device.get());
    std::vector<double> edits, commits, ratios;
    for (std::uint32_t i = 0; i < Rounds; ++i) {
        const std::uint32_t one = 7919 * (i + 1) % Instances;
        const glm::dmat4 to = instance_transform(one, 2.0);
        edits.push_back(crowd.timed(crowd.builder.move(ObjectId{10 + one}, to)));
        commits.push_back(bare.moved(one, glm::vec3(to[3])));
        ratios.push_back(edits.back() / commits.back());
    }
    std::printf("one of %u instances moved: edit %.2f ms, bare commit %.2f ms: x %.3f\n", Instances,
                bench::median(edits), bench::median(commits), bench::median(ratios));
}

}  // namespace
}  // namespace tessera::embree

int main() {
    using namespace tessera::embree;
    compare_refit();
    compare_instances();
}
