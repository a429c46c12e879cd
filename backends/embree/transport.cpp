#include "backends/embree/transport.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "backends/embree/light_sample.h"

namespace tessera::embree {

namespace {

Ray leaving(const Surface& surface, const glm::vec3& direction) {
    return {leave_surface({surface.position, surface.error}, surface.geometric_normal, direction), direction};
}

// Which part of the value is the diffuse lobe's.
glm::vec3 diffuse_share(const shading::BsdfValue& bsdf) {
    glm::vec3 share(0.0f);
    for (int i = 0; i < 3; ++i) {
        if (bsdf.value[i] > 0.0f) share[i] = bsdf.diffuse[i] / bsdf.value[i];
    }
    return share;
}

}  // namespace

std::string text(const glm::vec3& v) {
    char buffer[96];
    std::snprintf(buffer, sizeof buffer, "(%.9g, %.9g, %.9g)", double(v.x), double(v.y), double(v.z));
    return buffer;
}

LobeChances lobe_chances(const Surface& surface) {
    if (surface.rough_share == 1.0f) return {};
    const float reflection = shading::luminance(surface.specular.reflection);
    const float refraction = shading::luminance(surface.specular.refraction);
    const float sum = reflection + refraction + surface.bsdf.reflectance;
    if (!(sum > 0.0f)) return {0.0f, 0.0f, 0.0f};
    return {reflection / sum, refraction / sum, surface.bsdf.reflectance / sum};
}

void Transport::add_sky(Path& path, const Ray& ray) const {
    const SceneTables& tables = rays_.tables();
    if (!tables.environment.emits()) return;
    const glm::vec3 radiance = tables.environment.radiance(ray.direction);
    if (record_.keeps_connections()) record_.connect(path.sample, path.probability * radiance);
    float weight = 1.0f;
    if (path.bsdf_pdf > 0.0f) {
        const float other = environment_pdf(tables, ray.direction);
        if (strategy_ == Strategy::Both) weight = shading::power_heuristic(path.bsdf_pdf, other);
        if (strategy_ == Strategy::LightsOnly && other > 0.0f) weight = 0.0f;
    }
    record_.add(path.sample, path.throughput * radiance * weight, path.way);
}

void Transport::add_emission(Path& path, const Ray& ray, const Surface& surface) const {
    if (!(shading::largest(surface.emission) > 0.0f)) return;
    if (record_.keeps_connections()) record_.connect(path.sample, path.probability * surface.emission);
    float weight = 1.0f;
    if (path.bsdf_pdf > 0.0f) {
        const float other = mesh_light_pdf(rays_.tables(), surface, path.last_position);
        if (strategy_ == Strategy::Both) weight = shading::power_heuristic(path.bsdf_pdf, other);
        if (strategy_ == Strategy::LightsOnly && other > 0.0f) weight = 0.0f;
    }
    record_.add(path.sample, path.throughput * surface.emission * weight, path.way);
    path.tell([&] { return "  sees emission " + text(surface.emission) + " along " + text(ray.direction); });
}

void Transport::add_lights(Path& path, const Surface& surface, const glm::vec3& out) const {
    const SceneTables& tables = rays_.tables();
    if (strategy_ == Strategy::BsdfOnly && tables.lights.lights.empty()) return;
    const glm::vec2 choice = shading::sample_pair(path.sampler, pair_of(path.vertex, LightChoice));
    const glm::vec2 u = shading::sample_pair(path.sampler, pair_of(path.vertex, LightPoint));
    const LightSample light = sample_light(tables, surface, choice.x, u);
    if (!(light.pdf > 0.0f) || !(shading::largest(light.radiance) > 0.0f)) return;
    if (strategy_ == Strategy::BsdfOnly && !light.delta) return;
    if (!(glm::dot(light.direction, surface.geometric_normal) > 0.0f)) return;
    const shading::BsdfValue bsdf =
        shading::evaluate_bsdf(surface.bsdf, out, surface.to_local(light.direction));
    if (!(shading::largest(bsdf.value) > 0.0f)) return;
    const bool alone = light.delta || strategy_ == Strategy::LightsOnly;
    const float weight = alone ? 1.0f : shading::power_heuristic(light.pdf, bsdf.pdf);
    ++path.rays;
    if (rays_.occluded(light.origin, light.segment, light.far, path.shadow_seed())) return;
    const glm::vec3 gathered = path.throughput * bsdf.value * light.radiance * (weight / light.pdf);
    Way way{.scatterings = path.way.scatterings + 1, .diffuse_share = path.way.diffuse_share};
    if (record_.keeps_diffuse() && path.way.scatterings == 0) way.diffuse_share = diffuse_share(bsdf);
    record_.add(path.sample, gathered, way);
    if (record_.keeps_connections()) record_.connect(path.sample, path.probability * light.intensity);
    path.tell([&] { return "  light " + text(light.direction) + " adds " + text(gathered); });
}

Lobe Transport::rough_lobe(const Path& path) const {
    const glm::vec2 u = shading::sample_pair(path.sampler, pair_of(path.vertex, LobeAndRoulette));
    return {Lobe::Kind::Rough, u.x, u.y};
}

Lobe Transport::choose_lobe(Path& path, const Surface& surface) const {
    Lobe lobe = rough_lobe(path);
    if (surface.rough_share == 1.0f) return lobe;
    const LobeChances chances = lobe_chances(surface);
    const float specular = chances.reflection + chances.refraction;
    float first = specular, width = chances.rough;
    if (lobe.choice < chances.reflection) {
        lobe.kind = Lobe::Kind::Reflection;
        first = 0.0f;
        width = chances.reflection;
    } else if (lobe.choice < specular || !(chances.rough > 0.0f)) {
        lobe.kind = Lobe::Kind::Refraction;
        first = chances.reflection;
        width = chances.refraction;
    }
    if (!(width > 0.0f)) return {Lobe::Kind::None};
    lobe.choice = std::clamp((lobe.choice - first) / width, 0.0f, 0.99999994f);
    path.throughput /= width;
    return lobe;
}

bool Transport::scatter(Path& path, const Surface& surface, const glm::vec3& out, const Lobe& lobe,
                        Ray& ray) const {
    const glm::vec2 u = shading::sample_pair(path.sampler, pair_of(path.vertex, BsdfDirection));
    const glm::vec3 in = shading::sample_bsdf(surface.bsdf, out, lobe.choice, u);
    const shading::BsdfValue bsdf = shading::evaluate_bsdf(surface.bsdf, out, in);
    const glm::vec3 direction = glm::normalize(surface.to_world(in));
    if (!(bsdf.pdf > 0.0f) || !(glm::dot(direction, surface.geometric_normal) > 0.0f)) return false;
    path.throughput *= bsdf.value / bsdf.pdf;
    path.bsdf_pdf = bsdf.pdf;
    path.last_position = surface.position;
    if (record_.keeps_diffuse() && path.way.scatterings == 0) path.way.diffuse_share = diffuse_share(bsdf);
    ++path.way.scatterings;
    path.way.last = Way::Last::NonDelta;
    ray = leaving(surface, direction);
    return true;
}

void Transport::pass_on(Path& path, const Surface& surface, const Lobe& lobe, Ray& ray) const {
    const bool reflects = lobe.kind == Lobe::Kind::Reflection;
    path.throughput *= reflects ? surface.specular.reflection : surface.specular.refraction;
    path.bsdf_pdf = 0.0f;
    if (path.way.scatterings > 0) ++path.way.scatterings;
    path.way.last = Way::Last::Delta;
    ray = leaving(surface, reflects ? surface.specular.reflected : surface.specular.refracted);
    path.tell([&] { return (reflects ? "  reflected to " : "  refracted to ") + text(ray.direction); });
}

}  // namespace tessera::embree
