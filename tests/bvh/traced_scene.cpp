#include "tests/bvh/traced_scene.h"

#include <cmath>
#include <cstring>
#include <glm/geometric.hpp>

namespace tessera::vulkan {

namespace {

constexpr float Pi = 3.14159265f;

template <class T>
std::uint32_t append(std::vector<glm::uvec4>& pool, const std::vector<T>& row) {
    static_assert(sizeof(T) % sizeof(glm::uvec4) == 0 || sizeof(T) == 1);
    const auto place = static_cast<std::uint32_t>(pool.size());
    pool.resize(pool.size() + row.size() * sizeof(T) / sizeof(glm::uvec4));
    if (!row.empty()) std::memcpy(&pool[place], row.data(), row.size() * sizeof(T));
    return place;
}

RTCRayHit query_of(const TestRay& ray) {
    RTCRayHit query{};
    query.ray = {ray.origin.x,
                 ray.origin.y,
                 ray.origin.z,
                 ray.near,
                 ray.direction.x,
                 ray.direction.y,
                 ray.direction.z,
                 0.0f,
                 ray.far,
                 ~0u,
                 0,
                 0};
    query.hit.geomID = query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    return query;
}

}  // namespace

void TestMesh::add(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
    const auto first = static_cast<std::uint32_t>(positions.size());
    positions.insert(positions.end(), {a, b, c});
    triangles.emplace_back(first, first + 1, first + 2);
}

TracedScene::TracedScene(std::vector<TestMesh> meshes, const std::vector<TestInstance>& instances)
    : meshes_(std::move(meshes)), instances_(instances) {
    for (const TestMesh& mesh : meshes_) trees_.push_back(build_mesh(builder_, mesh.data()));
    lay_out();
    build_bvh2();
    make_embree();
}

std::vector<PlacedMesh> TracedScene::placed(const std::vector<PlacedMesh>& rows) const {
    std::vector<PlacedMesh> all;
    for (const TestInstance& instance : instances_) {
        PlacedMesh mesh = rows[instance.mesh];
        mesh.linear = instance.linear;
        mesh.translation = instance.translation;
        mesh.alpha_tested = true;
        mesh.layers = instance.layers;
        all.push_back(mesh);
    }
    return all;
}

void TracedScene::lay_out() {
    pool_.assign(1, glm::uvec4(0));  // so that no row is at 0 by chance
    std::vector<PlacedMesh> rows(meshes_.size());
    for (std::uint32_t i = 0; i < meshes_.size(); ++i) {
        std::vector<shading::BvhTriangle> triangles(trees_[i].primitives.size());
        write_triangles(trees_[i].primitives, meshes_[i].data(), triangles);
        rows[i].box = trees_[i].box;
        rows[i].nodes = append(pool_, trees_[i].nodes);
        rows[i].triangles = append(pool_, triangles);
    }
    top_ = build_top(builder_, placed(rows));
    top_place_ = append(pool_, top_.row);
}

void TracedScene::build_bvh2() {
    bvh2_pool_.assign(1, glm::uvec4(0));
    std::vector<PlacedMesh> rows(meshes_.size());
    for (std::uint32_t i = 0; i < meshes_.size(); ++i) {
        const Bvh2 tree = build_bvh2_mesh(builder_, meshes_[i].data());
        std::vector<shading::BvhTriangle> triangles(tree.primitives.size());
        write_triangles(tree.primitives, meshes_[i].data(), triangles);
        rows[i].box = trees_[i].box;
        rows[i].nodes = append(bvh2_pool_, tree.nodes);
        rows[i].triangles = append(bvh2_pool_, triangles);
    }
    bvh2_top_place_ = append(bvh2_pool_, build_bvh2_top(builder_, placed(rows)));
}

void TracedScene::make_embree() {
    embree_.reset();
    embree_meshes_.clear();
    device_.reset(rtcNewDevice("threads=1"));
    for (TestMesh& mesh : meshes_) {
        mesh.positions.reserve(mesh.positions.size() + 2);  // Embree reads 16 bytes at a time
        embree_meshes_.emplace_back(rtcNewScene(device_.get()));
        rtcSetSceneFlags(embree_meshes_.back().get(), RTC_SCENE_FLAG_ROBUST);
        RTCGeometry geometry = rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
        rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                   mesh.triangles.data(), 0, sizeof(glm::uvec3), mesh.triangles.size());
        rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                   mesh.positions.data(), 0, sizeof(glm::vec3), mesh.positions.size());
        rtcCommitGeometry(geometry);
        rtcAttachGeometryByID(embree_meshes_.back().get(), geometry, 0);
        rtcReleaseGeometry(geometry);
        rtcCommitScene(embree_meshes_.back().get());
    }
    embree_.reset(rtcNewScene(device_.get()));
    rtcSetSceneFlags(embree_.get(), RTC_SCENE_FLAG_ROBUST);
    for (std::uint32_t i = 0; i < instances_.size(); ++i) {
        RTCGeometry geometry = rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_INSTANCE);
        rtcSetGeometryInstancedScene(geometry, embree_meshes_[instances_[i].mesh].get());
        rtcSetGeometryTimeStepCount(geometry, 1);
        std::array<float, 12> columns;
        for (int c = 0; c < 3; ++c) std::memcpy(&columns[3 * c], &instances_[i].linear[c], 12);
        std::memcpy(&columns[9], &instances_[i].translation, 12);
        rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, columns.data());
        rtcCommitGeometry(geometry);
        rtcAttachGeometryByID(embree_.get(), geometry, i);
        rtcReleaseGeometry(geometry);
    }
    rtcCommitScene(embree_.get());
}

void TracedScene::move(std::uint32_t mesh, const std::vector<glm::vec3>& positions) {
    meshes_[mesh].positions = positions;
    refit_mesh(trees_[mesh], meshes_[mesh].data(), trees_[mesh].cost);
    lay_out();
    make_embree();
}

shading::Hit TracedScene::trace(const TestRay& ray, std::uint32_t question) const {
    return shading::bvh_trace(shading::BvhItems{pool_.data()}, top_place_, ray.origin, ray.direction,
                              ray.near, ray.far, question, ray.layers, ray.time, ThirdsPass{}, {});
}

shading::Hit TracedScene::trace_bvh2(const TestRay& ray, std::uint32_t question) const {
    return shading::bvh2_trace(shading::BvhItems{bvh2_pool_.data()}, bvh2_top_place_, ray.origin,
                               ray.direction, ray.near, ray.far, question, ray.layers, ray.time, ThirdsPass{},
                               {});
}

shading::Hit TracedScene::ask_all(const TestRay& ray, std::uint32_t question) const {
    using namespace shading;
    Hit best{NoInstance, 0, glm::vec2(0.0f), ray.far};
    for (std::size_t place = 0; place < top_.tree.nodes.size(); ++place) {
        if (top_.tree.primitives[place] == WideTree::NoPrimitive) continue;
        BvhInstance instance;
        std::memcpy(&instance, top_.row.data() + place * sizeof instance, sizeof instance);
        const auto to_object = [&](const glm::vec3& v) {
            return glm::vec3(bvh_row(instance.object_x, v), bvh_row(instance.object_y, v),
                             bvh_row(instance.object_z, v));
        };
        const BvhRay local = bvh_ray(
            to_object(ray.origin) + glm::vec3(instance.object_x.w, instance.object_y.w, instance.object_z.w),
            to_object(ray.direction));
        const std::uint32_t mesh = instances_[instance.instance].mesh;
        if ((instances_[instance.instance].layers & ray.layers) == 0) continue;
        for (const std::uint32_t triangle : trees_[mesh].primitives) {
            const glm::uvec3& t = meshes_[mesh].triangles[triangle];
            const auto& p = meshes_[mesh].positions;
            const BvhCrossing crossing = bvh_cross_triangle(local, p[t.x], p[t.y], p[t.z]);
            if (!crossing.crosses || !(crossing.distance > ray.near)) continue;
            if (!bvh_is_closer(best, crossing.distance, instance.instance, triangle)) continue;
            const Hit hit{instance.instance, triangle, crossing.barycentric, crossing.distance};
            if ((question & BvhAlpha) == 0 || stops_ray(ThirdsPass{}, hit, {})) best = hit;
        }
    }
    return best;
}

shading::Hit TracedScene::ask_embree(const TestRay& ray) const {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRayHit query = query_of(ray);
    rtcIntersect1(embree_.get(), &context, &query);
    const bool missed = query.hit.geomID == RTC_INVALID_GEOMETRY_ID;
    return {missed ? shading::NoInstance : query.hit.instID[0], query.hit.primID,
            glm::vec2(query.hit.u, query.hit.v), query.ray.tfar};
}

bool TracedScene::embree_occluded(const TestRay& ray) const {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRayHit query = query_of(ray);
    rtcOccluded1(embree_.get(), &context, &query.ray);
    return query.ray.tfar < 0.0f;
}

glm::vec3 random_point(CounterRandom& random, float low, float high) {
    const auto one = [&] { return low + (high - low) * static_cast<float>(random.uniform()); };
    const float x = one(), y = one(), z = one();
    return {x, y, z};
}

glm::vec3 random_direction(CounterRandom& random) {
    for (;;) {
        const glm::vec3 point = random_point(random, -1.0f, 1.0f);
        const float length = glm::length(point);
        if (length > 0.1f && length <= 1.0f) return point / length;
    }
}

TestMesh random_mesh(CounterRandom& random, std::uint32_t count, float size) {
    TestMesh mesh;
    for (std::uint32_t i = 0; i < count; ++i) {
        const glm::vec3 a = random_point(random, -size, size);
        // From fifty to the two-hundredth part; every fourth a sliver, every fourth along the axes.
        const float extent = size * std::exp2(-1.0f - 7.0f * static_cast<float>(random.uniform()));
        glm::vec3 b = a + random_point(random, -extent, extent),
                  c = a + random_point(random, -extent, extent);
        if (i % 4 == 1) c = glm::mix(a, b, 0.3f) + random_point(random, -1e-4f, 1e-4f) * extent;
        if (i % 4 == 2) b[i % 3] = c[i % 3] = a[i % 3];
        mesh.add(a, b, c);
    }
    return mesh;
}

TestMesh ball(std::uint32_t rows, float radius, const glm::vec3& centre) {
    TestMesh mesh;
    const std::uint32_t columns = 2 * rows;
    mesh.positions.push_back(centre + glm::vec3(0.0f, radius, 0.0f));
    for (std::uint32_t row = 1; row < rows; ++row) {
        for (std::uint32_t column = 0; column < columns; ++column) {
            const float theta = Pi * static_cast<float>(row) / static_cast<float>(rows);
            const float phi = 2.0f * Pi * static_cast<float>(column) / static_cast<float>(columns);
            const glm::vec3 n(std::sin(theta) * std::cos(phi), std::cos(theta),
                              std::sin(theta) * std::sin(phi));
            const float bump = 1.0f + 0.1f * std::sin(13.0f * n.x) * std::sin(17.0f * n.y);
            mesh.positions.push_back(centre + n * (radius * bump));
        }
    }
    mesh.positions.push_back(centre - glm::vec3(0.0f, radius, 0.0f));
    const auto last = static_cast<std::uint32_t>(mesh.positions.size() - 1);
    for (std::uint32_t column = 0; column < columns; ++column) {
        const std::uint32_t next = (column + 1) % columns;
        mesh.triangles.emplace_back(0, 1 + next, 1 + column);
        for (std::uint32_t row = 1; row + 1 < rows; ++row) {
            const std::uint32_t at = 1 + (row - 1) * columns, below = at + columns;
            mesh.triangles.emplace_back(at + column, at + next, below + column);
            mesh.triangles.emplace_back(at + next, below + next, below + column);
        }
        const std::uint32_t at = last - columns;
        mesh.triangles.emplace_back(at + column, at + next, last);
    }
    return mesh;
}

}  // namespace tessera::vulkan
