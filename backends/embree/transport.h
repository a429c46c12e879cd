#pragma once

#include <string>
#include <vector>

#include "backends/embree/light_record.h"
#include "backends/embree/ray_caster.h"
#include "backends/embree/surface.h"
#include "mediator/shading/sobol.h"

namespace tessera::embree {

// How light is found; the estimates agree in expectation. Only tests choose other than Both.
enum class Strategy { Both, LightsOnly, BsdfOnly };

// Where a path is: what it still carries and what it has gathered.
struct Path {
    shading::Sampler sampler;
    std::uint32_t vertex = 0;  // surfaces scattered at so far
    glm::vec3 throughput{1.0f};
    float probability = 1.0f;  // of this branch, where all branches are followed
    float bsdf_pdf = 0.0f;     // of the direction it travels; 0 = from the camera or a perfect specular
    glm::vec3 last_position{0.0f};
    Way way;  // that light takes which is found next
    PathSample sample;
    std::uint64_t rays = 0;
    std::vector<std::string>* story = nullptr;

    std::uint32_t closest_seed() const { return ray_seed(0); }
    std::uint32_t shadow_seed() const { return ray_seed(1); }
    // `line` makes the text, only where somebody listens.
    template <class Line>
    void tell(const Line& line) const {
        if (story != nullptr) story->push_back(line());
    }

  private:
    std::uint32_t ray_seed(std::uint32_t kind) const {
        return shading::hash_combine(shading::hash_combine(sampler.seed, sampler.index), 2 * vertex + kind);
    }
};

// Pairs of random numbers: the first is the camera's, then each vertex has its own.
inline constexpr std::uint32_t CameraPair = 0;
enum VertexPair : std::uint32_t { BsdfDirection, LobeAndRoulette, LightChoice, LightPoint, PairsPerVertex };
constexpr std::uint32_t pair_of(std::uint32_t vertex, VertexPair pair) {
    return 1 + vertex * PairsPerVertex + pair;
}

// One of a surface's lobe groups and the random numbers of this vertex that are left.
struct Lobe {
    enum class Kind : std::uint8_t { None, Rough, Reflection, Refraction } kind = Kind::Rough;
    float choice = 0.0f, roulette = 0.0f;  // uniform in [0, 1)
};

// Probabilities of the groups, in proportion to the luminance they pass on: reflection, refraction, the rest.
struct LobeChances {
    float reflection = 0.0f, refraction = 0.0f, rough = 1.0f;  // sum 1, or all 0 for a black surface
};
LobeChances lobe_chances(const Surface& surface);

// The steps of a path from surface to surface, shared by all ways to render. Next-event estimation with one
// light sample per vertex, combined with BSDF sampling by the power heuristic (Veach 1997); none of both at
// perfect speculars: what is seen in them counts in full.
class Transport {
  public:
    Transport(const RayCaster& rays, const view::View& view, Strategy strategy)
        : rays_(rays), record_(view), strategy_(strategy) {}

    const LightRecord& record() const { return record_; }

    void add_sky(Path& path, const Ray& ray) const;
    void add_emission(Path& path, const Ray& ray, const Surface& surface) const;
    void add_lights(Path& path, const Surface& surface, const glm::vec3& out) const;

    // Chooses and divides the throughput by the probability; None ends the path.
    Lobe choose_lobe(Path& path, const Surface& surface) const;
    // The rough group for certain, where the others are followed on their own.
    Lobe rough_lobe(const Path& path) const;
    // `ray` becomes the next one; false ends the path. The vertex is for the caller to count.
    bool scatter(Path& path, const Surface& surface, const glm::vec3& out, const Lobe& lobe, Ray& ray) const;
    void pass_on(Path& path, const Surface& surface, const Lobe& lobe, Ray& ray) const;

  private:
    const RayCaster rays_;
    LightRecord record_;
    Strategy strategy_;
};

// Coordinates and colours in a story.
std::string text(const glm::vec3& v);

}  // namespace tessera::embree
