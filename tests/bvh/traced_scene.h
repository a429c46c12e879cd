#pragma once

#include <embree3/rtcore.h>

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <vector>

#include "backends/vulkan/bvh/bvh2.h"
#include "backends/vulkan/bvh/mesh_bvh.h"
#include "backends/vulkan/bvh/top_bvh.h"
#include "mediator/base/random.h"
#include "mediator/shading/bvh_trace.h"

namespace tessera::vulkan {

struct TestMesh {
    std::vector<glm::vec3> positions;
    std::vector<glm::uvec3> triangles;

    MeshData data() const { return {positions, triangles}; }
    void add(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c);
};

struct TestInstance {
    std::uint32_t mesh = 0;
    glm::mat3 linear{1.0f};
    glm::vec3 translation{0.0f};
    std::uint32_t layers = shading::AllLayers;
};

struct TestRay {
    glm::vec3 origin, direction;
    float near = 1.17549435e-38f, far = INFINITY;
    std::uint32_t layers = shading::AllLayers;
    float time = 0.0f;
};

// Stops at all but every third triangle: CastSettings{.passes_every = 3}.
struct ThirdsPass {
    friend bool stops_ray(const ThirdsPass&, const shading::Hit& candidate, const shading::Sampler&) {
        return candidate.triangle % 3 != 0;
    }
};

// The same scene four times: in the pool, as binary BVHs, as a list of all triangles, and in Embree.
class TracedScene final {
  public:
    TracedScene(std::vector<TestMesh> meshes, const std::vector<TestInstance>& instances);

    shading::Hit trace(const TestRay& ray, std::uint32_t question = shading::BvhClosest) const;
    shading::Hit trace_bvh2(const TestRay& ray, std::uint32_t question = shading::BvhClosest) const;
    // Brute force: tests every triangle, without boxes.
    shading::Hit ask_all(const TestRay& ray, std::uint32_t question = shading::BvhClosest) const;
    shading::Hit ask_embree(const TestRay& ray) const;
    bool embree_occluded(const TestRay& ray) const;

    const TestInstance& instance(std::uint32_t i) const { return instances_[i]; }
    const TestMesh& mesh(std::uint32_t index) const { return meshes_[index]; }
    const WideTree& tree(std::uint32_t mesh) const { return trees_[mesh]; }
    const TopBvh& top() const { return top_; }
    const std::vector<glm::uvec4>& pool() const { return pool_; }
    std::uint32_t top_place() const { return top_place_; }
    const std::vector<glm::uvec4>& bvh2_pool() const { return bvh2_pool_; }
    std::uint32_t bvh2_top_place() const { return bvh2_top_place_; }
    // New positions, boxes by refit; instances stay. The binary BVHs are not rebuilt.
    void move(std::uint32_t mesh, const std::vector<glm::vec3>& positions);

  private:
    void lay_out();
    void build_bvh2();
    std::vector<PlacedMesh> placed(const std::vector<PlacedMesh>& rows) const;
    void make_embree();

    struct Release {
        void operator()(RTCDeviceTy* device) const { rtcReleaseDevice(device); }
        void operator()(RTCSceneTy* scene) const { rtcReleaseScene(scene); }
    };
    std::vector<TestMesh> meshes_;
    std::vector<TestInstance> instances_;
    BinaryTreeBuilder builder_;
    std::vector<WideTree> trees_;
    TopBvh top_;
    std::vector<glm::uvec4> pool_;
    std::uint32_t top_place_ = 0;
    std::vector<glm::uvec4> bvh2_pool_;
    std::uint32_t bvh2_top_place_ = 0;
    std::unique_ptr<RTCDeviceTy, Release> device_;
    std::vector<std::unique_ptr<RTCSceneTy, Release>> embree_meshes_;
    std::unique_ptr<RTCSceneTy, Release> embree_;
};

glm::vec3 random_point(CounterRandom& random, float low, float high);
glm::vec3 random_direction(CounterRandom& random);

// Triangles of all shapes around the origin, within +-`size`.
TestMesh random_mesh(CounterRandom& random, std::uint32_t count, float size);
// Closed; positions are those of a bumpy ball.
TestMesh ball(std::uint32_t rows, float radius, const glm::vec3& centre);

}  // namespace tessera::vulkan
