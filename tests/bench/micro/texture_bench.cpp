// Texture filtering by ray cones: gain and cost against point sampling.
//   tessera_texture_bench
// A floor of 10 cm checks of single texels up to the horizon, unlit, 320x200. Point sampling uses the same
// tables without mip levels. Errors are against 1024 point samples.
#include <gtest/gtest.h>

#include <cstdio>

#include "tests/bench/micro/model_timing.h"

namespace tessera::embree {
namespace {

using bench::median;
using bench::picture;
using bench::time_of;

constexpr std::uint32_t Width = 320, Height = 200, ReferenceSpp = 1024, Edge = 64, Rounds = 5;

void add_floor(Model& model) {
    std::vector<std::uint8_t> texels;
    for (std::uint32_t i = 0; i < Edge * Edge; ++i)
        texels.insert(texels.end(), 4, (i + i / Edge) % 2 == 0 ? std::uint8_t{255} : std::uint8_t{0});
    const scene::Texture checks{.width = Edge, .height = Edge, .filter = scene::TextureFilter::Linear};
    scene::Material paint{.base_color = glm::vec4(1.0f), .unlit = true};
    paint.base_color_texture = model.texture(checks, texels);
    constexpr float Half = 500.0f;
    model.textured_quad(model.material(paint),
                        {{{-Half, 0, Half}, {Half, 0, Half}, {Half, 0, -Half}, {-Half, 0, -Half}}},
                        2.0f * Half / (0.1f * Edge));
}

view::View ahead() {
    view::View view = small_view({0.0, 1.0, 0.0}, 0.8);
    view.width = Width;
    view.height = Height;
    view.window = {0, 0, static_cast<std::int32_t>(Width), static_cast<std::int32_t>(Height)};
    view.camera = view::perspective(glm::translate(glm::dmat4(1.0), glm::dvec3(0.0, 1.0, 0.0)), 0.8,
                                    static_cast<double>(Width) / Height);
    view.max_bounces = 0;
    return view;
}

double error(const std::vector<double>& found, const std::vector<double>& truth) {
    double sum = 0.0;
    for (std::size_t i = 0; i < found.size(); ++i) sum += (found[i] - truth[i]) * (found[i] - truth[i]);
    return sum / static_cast<double>(found.size());
}

void run() {
    Model model;
    add_floor(model);
    const SceneAdapter& world = model.build();
    const view::View view = ahead();
    backend::SceneTables points = world.tables();
    for (shading::Texture& texture : points.textures) texture.level_count = 0;
    const std::vector<double> truth = picture(world, points, view, ReferenceSpp, 99);
    for (const std::uint64_t spp : {1, 4, 16, 64}) {
        const double wide = error(picture(world, world.tables(), view, spp, 7), truth);
        const double narrow = error(picture(world, points, view, spp, 7), truth);
        std::printf("%3d samples per pixel: mean squared error %.3g, of points %.3g: %.2f x\n", int(spp),
                    wide, narrow, wide / narrow);
    }
    std::vector<double> ratios;
    for (std::uint32_t i = 0; i < Rounds; ++i)
        ratios.push_back(time_of(world, world.tables(), view, 8) / time_of(world, points, view, 8));
    std::printf("time per sample: %.2f x that of points (median of %u pairs)\n", median(ratios), Rounds);
}

}  // namespace
}  // namespace tessera::embree

int main() {
    tessera::embree::run();
    return testing::Test::HasFailure() ? 1 : 0;
}
