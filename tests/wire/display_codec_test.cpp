#include "mediator/wire/display_codec.h"

#include <gtest/gtest.h>

#include <random>

namespace tessera::wire {
namespace {

display::Display some_display() {
    scene::BlobStore store;
    const std::vector<std::byte> values(24, std::byte{7});
    const scene::BlobRef blob = scene::reference(*store.insert(values));
    display::Output output{.name = "left",
                           .width = 1440,
                           .height = 1050,
                           .x = -1440,
                           .y = 3,
                           .turn = display::Turn::Quarter,
                           .stereo = display::Stereo::TopBottom,
                           .priority = 4};
    output.plane = {{1, 2, -3}, {0, 0, 1}, {0, 1, 0}, {{1, 2, 3}, {4, 5, 6}, {7, 8, 9}}};
    output.view_width = 1050;
    output.view_height = 1440;
    output.points = {2, 1, 3, display::Grid::Nodes::Centres, blob};
    output.blend = {.left = 10, .bottom = 3, .shape = 2.0, .weights = output.points, .lift = output.points};
    output.color.gain = {0.5, 1.0, 2.0};
    output.color.matrix[2][1] = 0.25;
    output.color.gamma = 2.2;
    output.color.curve = {0.0f, 0.3f, 1.0f};
    display::Display display{.name = "wall", .camera = "main", .units_per_metre = 100.0};
    display.head = {{0.1, 1.7, 0.2}, {0.8, 0.0, 0.6, 0.0}};
    display.eye_separation = 0.06;
    display.zero_parallax = 2.5;
    display.spp = 64;
    display.coarsest = 2;
    display.max_bounces = 3;
    display.rate = 10.0;
    display.filter = "fdf";
    display.exposure = -1.5;
    display.white = 4.0;
    display.stereo_difference = true;
    display.layers = {{"model", view::Renderer::PathTracing, 1, true},
                      {"gui", view::Renderer::Raster, 2, false}};
    display.outputs = {output, {.name = "right"}};
    return display;
}

TEST(DisplayCodec, RoundTrips) {
    const display::Display display = some_display();
    const auto decoded = decode_display(encode(display));
    ASSERT_TRUE(decoded) << decoded.error().what();
    EXPECT_TRUE(*decoded == display);
}

TEST(DisplayCodec, ArbitraryBytesNeitherCrashNorThrow) {
    const std::vector<std::byte> good = encode(some_display());
    std::mt19937 random(5);
    std::size_t refused = 0;
    for (int run = 0; run < 20000; ++run) {
        std::vector<std::byte> bytes = good;
        if (run % 2 == 0) bytes.resize(random() % bytes.size());
        for (std::uint32_t flips = random() % 4; flips > 0 && !bytes.empty(); --flips)
            bytes[random() % bytes.size()] = std::byte(random());
        refused += decode_display(bytes) ? 0 : 1;
    }
    EXPECT_GT(refused, 1000u);
}

TEST(DisplayCodec, AnEnumeratorTooLargeAndTooManyOutputsAreRefused) {
    display::Display display = some_display();
    display.outputs[0].stereo = static_cast<display::Stereo>(99);
    EXPECT_FALSE(decode_display(encode(display)));
    display = some_display();
    display.outputs.resize(display::MaxOutputs + 1);
    EXPECT_FALSE(decode_display(encode(display)));
    display = some_display();
    display.head.orientation = {0.0, 0.0, 0.0, 0.0};
    EXPECT_FALSE(decode_display(encode(display)));
}

}  // namespace
}  // namespace tessera::wire
