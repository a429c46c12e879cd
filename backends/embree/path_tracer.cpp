#include "backends/embree/path_tracer.h"

#include <cmath>
#include <cstdio>
#include <limits>

#include "backends/embree/alpha.h"
#include "backends/embree/light_sample.h"
#include "backends/embree/surface.h"

namespace tessera::embree {

namespace {

using shading::Sampler;

constexpr float Infinity = std::numeric_limits<float>::infinity();
// Where the error bound is zero (an axis-aligned plane through the origin) a path starts on the surface
// exactly: only a hit at distance 0 has to be kept out.
constexpr float Near = std::numeric_limits<float>::min();
constexpr std::uint32_t RouletteFrom = 3;  // vertices that are never cut short

// Pairs of random numbers: the first is the camera's, then each vertex has its own.
constexpr std::uint32_t CameraPair = 0;
enum VertexPair : std::uint32_t { BsdfDirection, LobeAndRoulette, LightChoice, LightPoint, PairsPerVertex };
constexpr std::uint32_t pair_of(std::uint32_t vertex, VertexPair pair) {
    return 1 + vertex * PairsPerVertex + pair;
}

std::string text(const glm::vec3& v) {
    char buffer[96];
    std::snprintf(buffer, sizeof buffer, "(%.9g, %.9g, %.9g)", double(v.x), double(v.y), double(v.z));
    return buffer;
}

}  // namespace

// Where a path is: what it still carries and what it has gathered.
struct PathTracer::Path {
    Sampler sampler;
    std::uint32_t vertex = 0;  // surfaces scattered at so far
    glm::vec3 throughput{1.0f};
    float bsdf_pdf = 0.0f;  // of the direction it travels; 0 = from the camera
    glm::vec3 last_position{0.0f};
    PathSample sample;
    std::uint64_t rays = 0;
    std::vector<std::string>* story = nullptr;

    std::uint32_t ray_seed(std::uint32_t kind) const {
        return shading::hash_combine(shading::hash_combine(sampler.seed, sampler.index), 2 * vertex + kind);
    }
    // Light that was scattered `scatterings` times on its way from the source to the eye.
    void add(const glm::vec3& light, std::uint32_t scatterings) {
        (scatterings <= 1 ? sample.direct : sample.indirect) += light;
    }
    // `line` makes the text, only where somebody listens.
    template <class Line>
    void tell(const Line& line) const {
        if (story != nullptr) story->push_back(line());
    }
};

PathTracer::PathTracer(const SceneTables& tables, RTCScene scene, const view::View& view, Strategy strategy)
    : tables_(tables), scene_(scene), view_(view), strategy_(strategy) {
    const glm::dmat4& m = view.camera.world_from_camera;
    eye_ = glm::vec3(glm::dvec3(m[3]) - tables.render_origin);
    right_ = glm::vec3(m[0]);
    up_ = glm::vec3(m[1]);
    forward_ = -glm::vec3(m[2]);
}

PathTracer::Ray PathTracer::camera_ray(std::uint32_t x, std::uint32_t y, const glm::vec2& u) const {
    const float radius = view_.pixel_filter.radius;
    glm::vec2 offset = radius * (2.0f * u - 1.0f);
    if (view_.pixel_filter.kind == view::PixelFilterKind::Gaussian) {
        offset = {shading::gaussian_offset(u.x, radius), shading::gaussian_offset(u.y, radius)};
    } else if (view_.pixel_filter.kind == view::PixelFilterKind::BlackmanHarris) {
        offset = {shading::blackman_harris_offset(u.x, radius), shading::blackman_harris_offset(u.y, radius)};
    }
    // In double: a pixel's place in a picture of 65,536 leaves a float no bits for the place in the pixel.
    const view::CameraPose& camera = view_.camera;
    const double sx = (double(x) + 0.5 + double(offset.x)) / view_.width;
    const double sy = (double(y) + 0.5 + double(offset.y)) / view_.height;
    const auto px = static_cast<float>(camera.left + (camera.right - camera.left) * sx);
    const auto py = static_cast<float>(camera.top + (camera.bottom - camera.top) * sy);
    return {eye_, glm::normalize(forward_ + px * right_ + py * up_)};
}

bool PathTracer::intersect(const Ray& ray, const Path& path, RTCHit& hit, float& distance) const {
    TraceContext context;
    rtcInitIntersectContext(&context.embree);
    context.tables = &tables_;
    context.seed = path.ray_seed(0);
    RTCRayHit query;
    query.ray = {ray.origin.x,
                 ray.origin.y,
                 ray.origin.z,
                 Near,
                 ray.direction.x,
                 ray.direction.y,
                 ray.direction.z,
                 0.0f,
                 Infinity,
                 ~0u,
                 0,
                 0};
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(scene_, &context.embree, &query);
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return false;
    hit = query.hit;
    distance = query.ray.tfar;
    return true;
}

bool PathTracer::occluded(const glm::vec3& origin, const glm::vec3& to_target, float far,
                          const Path& path) const {
    TraceContext context;
    rtcInitIntersectContext(&context.embree);
    context.tables = &tables_;
    context.seed = path.ray_seed(1);
    RTCRay ray{origin.x,    origin.y, origin.z, Near, to_target.x, to_target.y,
               to_target.z, 0.0f,     far,      ~0u,  0,           0};
    rtcOccluded1(scene_, &context.embree, &ray);
    return ray.tfar < 0.0f;
}

void PathTracer::add_sky(Path& path, const Ray& ray) const {
    if (!tables_.environment.emits()) return;
    float weight = 1.0f;
    if (path.vertex > 0) {
        const float other = environment_pdf(tables_, ray.direction);
        if (strategy_ == Strategy::Both) weight = shading::power_heuristic(path.bsdf_pdf, other);
        if (strategy_ == Strategy::LightsOnly && other > 0.0f) weight = 0.0f;
    }
    path.add(path.throughput * tables_.environment.radiance(ray.direction) * weight, path.vertex);
}

void PathTracer::add_emission(Path& path, const Ray& ray, const Surface& surface) const {
    if (!(shading::largest(surface.emission) > 0.0f)) return;
    float weight = 1.0f;
    if (path.vertex > 0) {
        const float other = mesh_light_pdf(tables_, surface, path.last_position);
        if (strategy_ == Strategy::Both) weight = shading::power_heuristic(path.bsdf_pdf, other);
        if (strategy_ == Strategy::LightsOnly && other > 0.0f) weight = 0.0f;
    }
    path.add(path.throughput * surface.emission * weight, path.vertex);
    path.tell([&] { return "  sees emission " + text(surface.emission) + " along " + text(ray.direction); });
}

void PathTracer::add_lights(Path& path, const Surface& surface, const glm::vec3& out) const {
    if (strategy_ == Strategy::BsdfOnly && tables_.lights.lights.empty()) return;
    const glm::vec2 choice = shading::sample_pair(path.sampler, pair_of(path.vertex, LightChoice));
    const glm::vec2 u = shading::sample_pair(path.sampler, pair_of(path.vertex, LightPoint));
    const LightSample light = sample_light(tables_, surface, choice.x, u);
    if (!(light.pdf > 0.0f) || !(shading::largest(light.radiance) > 0.0f)) return;
    if (strategy_ == Strategy::BsdfOnly && !light.delta) return;
    if (!(glm::dot(light.direction, surface.geometric_normal) > 0.0f)) return;
    const shading::BsdfValue bsdf =
        shading::evaluate_bsdf(surface.bsdf, out, surface.to_local(light.direction));
    if (!(shading::largest(bsdf.value) > 0.0f)) return;
    const bool alone = light.delta || strategy_ == Strategy::LightsOnly;
    const float weight = alone ? 1.0f : shading::power_heuristic(light.pdf, bsdf.pdf);
    ++path.rays;
    if (occluded(light.origin, light.segment, light.far, path)) return;
    const glm::vec3 gathered = path.throughput * bsdf.value * light.radiance * (weight / light.pdf);
    path.add(gathered, path.vertex + 1);
    path.tell([&] { return "  light " + text(light.direction) + " adds " + text(gathered); });
}

bool PathTracer::scatter(Path& path, const Surface& surface, const glm::vec3& out, Ray& ray) const {
    const glm::vec2 choice = shading::sample_pair(path.sampler, pair_of(path.vertex, LobeAndRoulette));
    const glm::vec2 u = shading::sample_pair(path.sampler, pair_of(path.vertex, BsdfDirection));
    const glm::vec3 in = shading::sample_bsdf(surface.bsdf, out, choice.x, u);
    const shading::BsdfValue bsdf = shading::evaluate_bsdf(surface.bsdf, out, in);
    const glm::vec3 direction = glm::normalize(surface.to_world(in));
    if (!(bsdf.pdf > 0.0f) || !(glm::dot(direction, surface.geometric_normal) > 0.0f)) return false;
    path.throughput *= bsdf.value / bsdf.pdf;
    if (path.vertex >= RouletteFrom) {
        const float survives = std::fmin(shading::largest(path.throughput), 1.0f);
        if (!(choice.y < survives)) return false;
        path.throughput /= survives;
    }
    if (!(shading::largest(path.throughput) > 0.0f)) return false;
    path.bsdf_pdf = bsdf.pdf;
    path.last_position = surface.position;
    ++path.vertex;
    ray = {leave_surface({surface.position, surface.error}, surface.geometric_normal, direction), direction};
    return true;
}

PathSample PathTracer::trace(std::uint32_t x, std::uint32_t y, std::uint64_t sample, std::uint64_t& rays,
                             std::vector<std::string>* story) const {
    Path path{.sampler = shading::make_sampler(x, y, view_.seed, sample), .story = story};
    Ray ray = camera_ray(x, y, shading::sample_pair(path.sampler, CameraPair));
    path.sample.depth = Infinity;
    path.tell([&] { return "camera " + text(ray.origin) + " looks along " + text(ray.direction); });
    // Light scattered up to max_bounces + 1 times is counted, so 0 is direct light (as in Cycles).
    const std::uint64_t max_scatterings = view_.max_bounces == view::UnlimitedBounces
                                              ? ~std::uint64_t{0}
                                              : std::uint64_t{view_.max_bounces} + 1;
    while (true) {
        RTCHit hit;
        float distance = 0.0f;
        ++path.rays;
        if (!intersect(ray, path, hit, distance)) {
            path.tell([&] { return std::string("leaves the scene"); });
            add_sky(path, ray);
            break;
        }
        const Surface surface = make_surface(tables_, hit, ray.direction);
        path.tell([&] {
            return "hits object " + std::to_string(surface.instance->object) + " triangle " +
                   std::to_string(surface.triangle) + " at " + text(surface.position) + " with normal " +
                   text(surface.frame[2]) + ", carries " + text(path.throughput);
        });
        if (path.vertex == 0) {
            path.sample.albedo = surface.albedo;
            path.sample.normal = surface.frame[2];
            path.sample.depth = distance * glm::dot(ray.direction, forward_);
            path.sample.object = surface.instance->object;
        }
        add_emission(path, ray, surface);
        if (!surface.scatters || path.vertex >= max_scatterings) break;
        const glm::vec3 out = surface.to_local(-ray.direction);
        add_lights(path, surface, out);
        if (!scatter(path, surface, out, ray)) break;
    }
    rays += path.rays;
    return path.sample;
}

}  // namespace tessera::embree
