// Many lights: gain and cost of the light tree against uniform selection. Light in fog: gain of equiangular
// sampling over free flight sampling alone. Skies: gain of the choice by irradiance over an even choice, and of light samples of
// the sky over BSDF samples alone.
//   tessera_light_bench [fog|trees|skies]
// 10,000 emissive one-sided triangles of 0.1 m over a ground of 100 m, of all orientations, with powers over
// two orders of magnitude. Uniform selection uses the same tree with equal importances, so its time is not
// meaningful: instead, the time of a scene with a single emissive triangle is used.
#include <gtest/gtest.h>

#include <cstdio>
#include <string_view>

#include "mediator/backend/tables/light_tree.h"
#include "mediator/base/random.h"
#include "tests/bench/micro/model_timing.h"

namespace tessera::embree {
namespace {

using bench::cpu_seconds;
using bench::median;
using bench::picture;
using bench::time_of;

constexpr std::uint32_t Emitters = 10000, Size = 64, Spp = 64, ReferenceSpp = 1024, Rounds = 9;
constexpr std::uint32_t FogReferenceSpp = 256, FogRounds = 5;

// The first `emissive` triangles emit; the very first is above the visible ground and faces down.
void add_lamps(Model& model, std::uint32_t emissive) {
    CounterRandom random(1);
    const auto number = [&] { return static_cast<float>(2.0 * random.uniform() - 1.0); };
    model.floor(model.material(chalk(glm::vec3(0.7f))), 50.0f, 0.0f);
    std::vector<std::array<glm::vec3, 3>> bright, dark;
    for (std::uint32_t i = 0; i < Emitters; ++i) {
        const glm::vec3 position(50.0f * number(), 50.0f * number(), 2.0f + number());
        const float size = 0.05f * std::pow(10.0f, number());
        std::array<glm::vec3, 3> corners;
        for (glm::vec3& corner : corners) corner = position + size * glm::vec3(number(), number(), number());
        if (i == 0) corners = {{{0.0f, 1.0f, 2.0f}, {0.0f, 1.1f, 2.0f}, {0.1f, 1.0f, 2.0f}}};
        (i < emissive ? bright : dark).push_back(corners);
    }
    scene::Material emissive_material = lamp(1000.0f);
    emissive_material.double_sided = false;
    model.triangles(model.material(emissive_material), bright);
    model.triangles(model.material(chalk(glm::vec3(0.0f))), dark);
}

// Views the ground only, from below all lamps: visible small lamps would add noise.
view::View ground() {
    const glm::dmat4 turn = glm::rotate(glm::dmat4(1.0), 0.8, {1.0, 0.0, 0.0});
    view::View view = small_view({0.0, 0.0, 0.9}, 0.9, Size, turn);
    view.max_bounces = 0;
    return view;
}

// Equal importance of all emitters from everywhere.
backend::SceneTables uniform(backend::SceneTables tables) {
    std::vector<shading::LightNode>& nodes = tables.light_nodes;
    for (shading::LightNode& node : nodes) {
        node.power = (node.link & shading::LightLeaf) != 0 ? 1.0f : 0.0f;
        node.radius = 1e6f;
    }
    for (std::size_t i = nodes.size(); i-- > 1;) nodes[nodes[i].parent].power += nodes[i].power;
    return tables;
}

double relmse(const std::vector<double>& found, const std::vector<double>& truth) {
    double sum = 0.0;
    for (std::size_t i = 0; i < found.size(); ++i) {
        const double d = found[i] - truth[i];
        sum += d * d / (truth[i] * truth[i] + 1e-4);
    }
    return sum / static_cast<double>(found.size());
}

double sum_of(const std::vector<double>& pixels) {
    double sum = 0.0;
    for (const double pixel : pixels) sum += pixel;
    return sum;
}

void run() {
    Model many, one;
    add_lamps(many, Emitters);
    add_lamps(one, 1);
    const SceneAdapter& world = many.build();
    const SceneAdapter& single = one.build();
    const view::View view = ground();
    const backend::SceneTables even = uniform(world.tables());
    std::vector<double> times, single_times, ratios;
    for (std::uint32_t i = 0; i < Rounds; ++i) {
        times.push_back(time_of(world, world.tables(), view, 16));
        single_times.push_back(time_of(single, single.tables(), view, 16));
        ratios.push_back(times.back() / single_times.back());
    }
    const double time = median(times), single_time = median(single_times);
    std::printf("time per sample: %.0f ns with %u emitters, %.0f ns with one: %.2f x\n", time, Emitters,
                single_time, median(ratios));
    const std::vector<double> truth = picture(world, world.tables(), view, ReferenceSpp, 99);
    const std::vector<double> tree = picture(world, world.tables(), view, Spp, 1);
    const std::vector<double> plain = picture(world, even, view, Spp, 1);
    const double tree_error = relmse(tree, truth), plain_error = relmse(plain, truth);
    std::printf("relMSE at %u samples: tree %.4g, uniform %.4g; at equal time %.4f x\n", Spp, tree_error,
                plain_error, tree_error / plain_error * time / single_time);
    std::printf("mean light, tree / reference %.4f, uniform / reference %.4f\n", sum_of(tree) / sum_of(truth),
                sum_of(plain) / sum_of(truth));
}

// ---- fog ----

struct FogScene {
    const char* name;
    float scattering;
    scene::Light light;
    bool with_floor;
    double lamp_z = 0.0;  // the fog's front is at 2 m
};

glm::dmat4 lamp_transform(double z) {
    return glm::translate(glm::dmat4(1.0), glm::dvec3(0, 1.8, z)) *
           glm::rotate(glm::dmat4(1.0), -1.3, {1, 0, 0});
}

std::vector<double> foggy_picture(const SceneAdapter& world, const view::View& view, Strategy strategy,
                                  std::uint64_t spp, double& seconds) {
    const PathTracer tracer(world.tables(), world.scene(), view, strategy);
    std::vector<double> pixels(Size * Size);
    std::uint64_t rays = 0;
    const double start = cpu_seconds();
    for (std::uint64_t sample = 0; sample < spp; ++sample) {
        for (std::uint32_t i = 0; i < Size * Size; ++i) {
            pixels[i] += red(tracer.trace(i % Size, i / Size, sample, rays)) / static_cast<double>(spp);
        }
    }
    seconds += cpu_seconds() - start;
    return pixels;
}

// Errors and times of both strategies in turn; the reference uses both with many samples.
void run_fog(const FogScene& fog) {
    Model model;
    model.set_medium(
        {.absorption = glm::vec3(0.02f), .scattering = glm::vec3(fog.scattering), .anisotropy = 0.3f});
    model.box(ObjectId{}, {-2, -2, -2}, {2, 2, 2});
    model.clear_medium();
    if (fog.with_floor) {
        model.quad(
            model.material(chalk(glm::vec3(0.5f))),
            {{{-1.9f, -1.5f, 1.9f}, {1.9f, -1.5f, 1.9f}, {1.9f, -1.5f, -1.9f}, {-1.9f, -1.5f, -1.9f}}});
    }
    model.light(fog.light, lamp_transform(fog.lamp_z));
    const SceneAdapter& world = model.build();
    view::View view = small_view({0, 0, 6}, 0.6, Size);
    view.max_bounces = 4;
    double seconds[2] = {0, 0}, errors[2] = {0, 0}, unused = 0;
    constexpr Strategy Strategies[2] = {Strategy::FlightOnly, Strategy::Both};
    view.seed = 99;
    const std::vector<double> truth = foggy_picture(world, view, Strategy::Both, FogReferenceSpp, unused);
    for (std::uint32_t round = 0; round < FogRounds; ++round) {
        view.seed = round;
        for (int strategy = 0; strategy < 2; ++strategy) {
            errors[strategy] +=
                relmse(foggy_picture(world, view, Strategies[strategy], 16, seconds[strategy]), truth);
        }
    }
    std::printf("%-22s relMSE %.4g -> %.4g, time %.2f x; at equal time %.3f x\n", fog.name,
                errors[0] / FogRounds, errors[1] / FogRounds, seconds[1] / seconds[0],
                errors[1] / errors[0] * seconds[1] / seconds[0]);
    std::fflush(stdout);
}

void run_fogs() {
    const scene::Light spot{.kind = scene::LightKind::Spot,
                            .intensity = glm::vec3(10.0f),
                            .inner_cone_angle = 0.2f,
                            .outer_cone_angle = 0.4f};
    const scene::Light point{.kind = scene::LightKind::Point, .intensity = glm::vec3(3.0f)};
    const scene::Light sphere{
        .kind = scene::LightKind::Sphere, .intensity = glm::vec3(30.0f), .radius = 0.1f};
    const scene::Light quad{
        .kind = scene::LightKind::Quad, .intensity = glm::vec3(20.0f), .size = {0.4f, 0.4f}};
    const scene::Light sun{.kind = scene::LightKind::Directional, .intensity = glm::vec3(1.0f)};
    for (const FogScene& fog :
         {FogScene{"spot, thin fog", 0.05f, spot, false},
          FogScene{"spot, thin fog, floor", 0.05f, spot, true},
          FogScene{"spot, fog, floor", 0.4f, spot, true}, FogScene{"spot, dense fog", 4.0f, spot, false, 1.5},
          FogScene{"point, fog, floor", 0.4f, point, true},
          FogScene{"point, dense fog", 4.0f, point, false, 1.5},
          FogScene{"sphere, fog, floor", 0.4f, sphere, true}, FogScene{"quad, fog, floor", 0.4f, quad, true},
          FogScene{"sun, fog, floor", 0.4f, sun, true}}) {
        run_fog(fog);
    }
}

// ---- skies ----

// An overcast sky, with a sun of `peak` times the zenith in one texel.
void add_sky(Model& model, float peak) {
    constexpr std::uint32_t Width = 128, Height = 64;
    std::vector<glm::vec3> texels;
    for (std::uint32_t y = 0; y < Height; ++y) {
        const double theta = M_PI * (y + 0.5) / Height;
        const double value = theta < 0.5 * M_PI ? (1.0 + 2.0 * std::cos(theta)) / 3.0 : 0.1;
        texels.insert(texels.end(), Width, glm::vec3(static_cast<float>(value)));
    }
    if (peak > 0.0f) texels[20 * Width + 90] = glm::vec3(peak);
    scene::Background background{.strength = 1.0f};
    background.environment =
        model.texture({.width = Width, .height = Height, .format = scene::TexelFormat::RgbFloat}, texels)
            .texture;
    model.sky(background);
}

// A room of 8 x 8 x 3 m, y up, with one side open; a lamp under its ceiling.
void add_room(Model& model) {
    const ObjectId wall = model.material(chalk(glm::vec3(0.7f)));
    model.quad(wall, {{{-4, 0, 4}, {4, 0, 4}, {4, 0, -4}, {-4, 0, -4}}});
    model.quad(wall, {{{-4, 3, 4}, {-4, 3, -4}, {4, 3, -4}, {4, 3, 4}}});
    model.quad(wall, {{{-4, 0, -4}, {4, 0, -4}, {4, 3, -4}, {-4, 3, -4}}});
    model.quad(wall, {{{-4, 0, 4}, {-4, 0, -4}, {-4, 3, -4}, {-4, 3, 4}}});
    model.quad(wall, {{{-4, 0, 4}, {-4, 3, 4}, {4, 3, 4}, {4, 0, 4}}});
    model.quad(
        model.material(lamp(20.0f)),
        {{{-0.25f, 2.9f, -0.25f}, {0.25f, 2.9f, -0.25f}, {0.25f, 2.9f, 0.25f}, {-0.25f, 2.9f, 0.25f}}});
}

// relMSE x time of a choice of lights without regard to where they are, and of BSDF samples alone, against the renderer's.
void run_sky(const char* name, bool has_room, float peak) {
    Model model;
    add_sky(model, peak);
    model.quad(model.material(chalk(glm::vec3(0.5f))),
               {{{-99, -0.01f, 99}, {99, -0.01f, 99}, {99, -0.01f, -99}, {-99, -0.01f, -99}}});
    if (has_room) add_room(model);
    const SceneAdapter& world = model.build();
    backend::SceneTables even = world.tables();
    even.scene.tree_intensity = 0.0f;
    for (shading::LightSource& light : even.lights) light.irradiance = 0.0f;
    view::View view =
        small_view({0.0, 2.0, 3.5}, 1.0, Size, glm::rotate(glm::dmat4(1.0), -0.6, {1.0, 0.0, 0.0}));
    view.max_bounces = 0;
    const std::vector<double> truth = picture(world, world.tables(), view, ReferenceSpp, 99);
    const auto cost = [&](const backend::SceneTables& tables, Strategy strategy) {
        view.seed = 1;
        const PathTracer tracer(tables, world.scene(), view, strategy);
        std::vector<double> pixels(Size * Size);
        std::uint64_t rays = 0;
        const double start = cpu_seconds();
        for (std::uint64_t sample = 0; sample < Spp; ++sample) {
            for (std::uint32_t i = 0; i < Size * Size; ++i)
                pixels[i] += red(tracer.trace(i % Size, i / Size, sample, rays)) / Spp;
        }
        return relmse(pixels, truth) * (cpu_seconds() - start);
    };
    std::vector<double> evens, bsdfs;
    for (std::uint32_t round = 0; round < Rounds; ++round) {
        const double own = cost(world.tables(), Strategy::Both);
        evens.push_back(cost(even, Strategy::Both) / own);
        bsdfs.push_back(cost(world.tables(), Strategy::BsdfOnly) / own);
    }
    std::printf("%-22s relMSE x time: even choice %.2f x, BSDF samples alone %.2f x\n", name, median(evens),
                median(bsdfs));
    std::fflush(stdout);
}

void run_skies() {
    run_sky("overcast, open", false, 0.0f);
    run_sky("sun in the sky, open", false, 2e4f);
    run_sky("overcast, room", true, 0.0f);
    run_sky("sun in the sky, room", true, 2e4f);
}

// Build times of light trees.
void run_builds() {
    for (const std::uint32_t count : {10000u, 1000000u}) {
        CounterRandom random(2);
        std::vector<backend::LightLeaf> leaves;
        for (std::uint32_t i = 0; i < count; ++i) {
            const glm::dvec3 position(random.uniform(), random.uniform(), random.uniform());
            leaves.push_back({.low = position,
                              .high = position + glm::dvec3(1e-3),
                              .axis = glm::normalize(position - glm::dvec3(0.5)),
                              .emission_angle = 1.57,
                              .power = 1.0,
                              .emitter = i});
        }
        std::vector<shading::Emitter> emitters(count);
        std::vector<double> times;
        for (std::uint32_t i = 0; i < 5; ++i) {
            const double start = cpu_seconds();
            backend::make_light_tree(leaves, emitters);
            times.push_back((cpu_seconds() - start));
        }
        std::printf("tree of %u: %.1f ms\n", count, 1e3 * median(times));
    }
}

}  // namespace
}  // namespace tessera::embree

int main(int count, char** arguments) {
    const std::string_view part = count > 1 ? arguments[1] : "";
    if (part == "" || part == "skies") tessera::embree::run_skies();
    if (part == "" || part == "fog") tessera::embree::run_fogs();
    if (part == "fog" || part == "skies") return 0;
    tessera::embree::run_builds();
    tessera::embree::run();
}
