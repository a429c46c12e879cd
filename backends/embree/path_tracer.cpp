#include "backends/embree/path_tracer.h"

#include <limits>

#include "backends/embree/whitted.h"

namespace tessera::embree {

namespace {

constexpr std::uint32_t RouletteFrom = 3;  // vertices that are never cut short
// From here on nothing goes on for certain: a path that perfect mirrors or total reflection keep inside of a
// body has to end. Diffuse paths do not come so far: albedo 0.99 survives 1024 times in 30,000.
constexpr std::uint32_t NothingCertainFrom = 1024;
constexpr float AtMost = 0.95f;

bool survives(Path& path, float choice) {
    if (path.vertex >= RouletteFrom) {
        const float most = path.vertex >= NothingCertainFrom ? AtMost : 1.0f;
        const float probability = shading::lesser_of(shading::largest(path.throughput), most);
        if (!(choice < probability)) return false;
        path.throughput /= probability;
    }
    return shading::largest(path.throughput) > 0.0f;
}

void tell_hit(const Path& path, const Surface& surface) {
    path.tell([&] {
        return "hits object " + std::to_string(surface.instance->object) + " triangle " +
               std::to_string(surface.triangle) + " at " + text(surface.position) + " with normal " +
               text(surface.frame[2]) + ", carries " + text(path.throughput);
    });
}

void tell_miss(const Path& path) {
    path.tell([&] { return std::string("leaves the scene"); });
}

bool any_light(frame::ChannelSet channels) {
    using enum frame::Channel;
    constexpr frame::ChannelSet Light{Radiance,       LowVariance, HighVariance,
                                      ShadingFeature, Irradiance,  EvenHalf};
    return channels.empty() || (channels.bits() & Light.bits()) != 0;  // empty: a probe wants the whole path
}

}  // namespace

PathTracer::PathTracer(const SceneTables& tables, RTCScene scene, const view::View& view, Strategy strategy)
    : rays_(tables, scene),
      view_(view),
      camera_(view, tables.render_origin),
      transport_(rays_, view, strategy),
      // Light scattered up to max_bounces + 1 times is counted, so 0 is direct light (as in Cycles).
      max_scatterings_(view.max_bounces == view::UnlimitedBounces ? ~std::uint64_t{0}
                                                                  : std::uint64_t{view.max_bounces} + 1),
      wants_light_(any_light(view.channels)) {}

void PathTracer::trace_path(Path& path, Ray ray, Hit hit) const {
    while (true) {
        const Surface surface = make_surface(rays_.tables(), hit.hit, ray.direction);
        tell_hit(path, surface);
        if (path.vertex == 0) {
            path.sample.object = surface.instance->object;
            if (view_.channels.contains(frame::Channel::Range))
                path.sample.range = range_of(rays_, ray, surface, path);
        }
        transport_.add_emission(path, ray, surface);
        const Lobe lobe = transport_.choose_lobe(path, surface);
        if (lobe.kind == Lobe::Kind::None) return;
        if (lobe.kind == Lobe::Kind::Rough && path.way.scatterings == 0) {
            path.sample.albedo = surface.albedo * surface.rough_share * path.throughput;
            path.sample.normal = surface.frame[2];
        }
        if (!surface.scatters || path.vertex >= max_scatterings_) return;
        if (lobe.kind == Lobe::Kind::Rough) {
            const glm::vec3 out = surface.to_local(-ray.direction);
            transport_.add_lights(path, surface, out);
            if (!transport_.scatter(path, surface, out, lobe, ray)) return;
        } else {
            transport_.pass_on(path, surface, lobe, ray);
        }
        if (!survives(path, lobe.roulette)) return;
        ++path.vertex;
        ++path.rays;
        const std::optional<Hit> next = rays_.closest(ray, path.closest_seed());
        if (!next) {
            tell_miss(path);
            return transport_.add_sky(path, ray);
        }
        hit = *next;
    }
}

PathSample PathTracer::trace(std::uint32_t x, std::uint32_t y, std::uint64_t sample, std::uint64_t& rays,
                             std::vector<std::string>* story) const {
    Path path{.sampler = shading::make_sampler(x, y, view_.seed, sample), .story = story};
    const Ray ray = camera_.ray(x, y, shading::sample_pair(path.sampler, CameraPair));
    path.tell([&] { return "camera " + text(ray.origin) + " looks along " + text(ray.direction); });
    ++path.rays;
    const std::optional<Hit> hit = rays_.closest(ray, path.closest_seed());
    path.sample.depth = hit ? camera_.depth(ray, hit->distance) : std::numeric_limits<float>::infinity();
    if (!hit) {
        tell_miss(path);
        if (!view_.transparent_background) transport_.add_sky(path, ray);
    } else if (view_.renderer == view::Renderer::Whitted) {
        const Surface surface = make_surface(rays_.tables(), hit->hit, ray.direction);
        path.sample.object = surface.instance->object;
        tell_hit(path, surface);
        trace_whitted(rays_, transport_, ray, surface, view_.channels, path);
    } else {
        trace_path(path, ray, *hit);
    }
    rays += path.rays;
    return path.sample;
}

}  // namespace tessera::embree
