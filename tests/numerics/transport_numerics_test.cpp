// Float arithmetic of the shared transport against double, at the limits of precision: huge pictures, tiny, huge
// and needle-like triangles, coordinates far outside of a texture.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/mat3x3.hpp>

#include "mediator/backend/tables/view_record.h"
#include "mediator/base/random.h"
#include "mediator/shading/camera.h"
#include "mediator/shading/environment.h"
#include "mediator/shading/textures.h"
#include "mediator/shading/triangle_points.h"

namespace tessera::shading {
namespace {

constexpr double TransportUlp = 0x1p-24;

// A ray leads to its own place within the pixel, up to a few roundings of the picture's edge: in a picture of
// 65,536 pixels that is 1 % of a pixel.
TEST(CameraNumerics, HugePicturesKeepSubpixelPositions) {
    struct Picture {
        std::uint32_t size;
        double left, right;
    };
    for (const auto& [size, left, right] : {Picture{16, -1.0, 1.0}, Picture{65536, -0.5, 0.5},
                                            Picture{65536, 2.0, 3.0}, Picture{1u << 20, -4.0, -3.9}}) {
        view::View view;
        view.width = view.height = size;
        view.camera = {.left = left, .right = right, .bottom = left, .top = right};
        const View record = backend::make_view(view, {});
        const double pixel = (right - left) / size;
        const double bound = 6.0 * TransportUlp * std::max(std::fabs(left), std::fabs(right)) / pixel;
        for (const std::uint32_t x : {0u, 1u, size / 3, size / 2, size - 1}) {
            for (const float u : {0.0f, 0.25f, 0.5f, 0.99f}) {
                const Ray ray = camera_ray(record, x, x, {u, u});
                const double place = double(x) + double(u);
                const double px = -double(ray.direction.x) / double(ray.direction.z);
                const double py = -double(ray.direction.y) / double(ray.direction.z);
                EXPECT_NEAR((px - left) / pixel, place, bound) << size << " " << x << " " << u;
                EXPECT_NEAR((right - py) / pixel, place, bound) << size << " " << x << " " << u;
            }
        }
    }
}

glm::dvec3 random_direction(CounterRandom& random) {
    const double z = 2.0 * random.uniform() - 1.0, phi = 2.0 * M_PI * random.uniform();
    const double r = std::sqrt(1.0 - z * z);
    return {r * std::cos(phi), r * std::sin(phi), z};
}

// Of needles as thin as 1 : 100,000, small as atoms and large as galaxies, in the middle of their
// coordinate range.
TEST(TriangleNumerics, NormalsMatchDoublePrecision) {
    CounterRandom random(3);
    const Instance instance{.linear = glm::mat3(1.0f), .normals = glm::mat3(1.0f)};
    for (const double size : {1.0, 1e-10, 1e-25, 1e18}) {
        for (const double thin : {1.0, 1e-2, 1e-5}) {
            for (int i = 0; i < 300; ++i) {
                const glm::dvec3 from = random_direction(random), along = random_direction(random);
                const glm::dvec3 across = glm::normalize(glm::cross(along, random_direction(random)));
                std::array<glm::vec3, 3> corners{glm::vec3(size * from), glm::vec3(size * (from + along)),
                                                 glm::vec3(size * (from + thin * across))};
                const unsigned turn = static_cast<unsigned>(random.bits() % 3u);
                const Triangle triangle{corners[turn], corners[(turn + 1) % 3], corners[(turn + 2) % 3]};
                const glm::dvec3 p = triangle.p, q = triangle.q, r = triangle.r;
                const glm::dvec3 expected = glm::normalize(glm::cross((q - p) / size, (r - p) / size));
                const glm::dvec3 found = face_normal(instance, triangle, glm::vec3(0.0f));
                ASSERT_NEAR(glm::length(found), 1.0, 4.0 * TransportUlp);
                ASSERT_LT(glm::length(found - expected), 16.0 * TransportUlp) << size << " " << thin;
            }
        }
    }
    const Triangle none{glm::vec3(1.0f), glm::vec3(2.0f), glm::vec3(3.0f)};
    EXPECT_EQ(face_normal(instance, none, glm::vec3(0.0f, 1.0f, 0.0f)), glm::vec3(0.0f, 1.0f, 0.0f));
}

TEST(ScalingNumerics, DirectionsAndDistancesMatchDoublePrecision) {
    CounterRandom random(4);
    for (double size = 1e-37; size < 1e38; size *= 10.0) {
        const glm::dvec3 direction = random_direction(random);
        const DirectionAndDistance offset = direction_and_distance(glm::vec3(size * direction));
        EXPECT_NEAR(offset.distance / size, 1.0, 8.0 * TransportUlp) << size;
        EXPECT_LT(glm::length(glm::dvec3(offset.direction) - direction), 8.0 * TransportUlp) << size;
    }
    EXPECT_EQ(direction_and_distance(glm::vec3(0.0f)).distance, 0.0f);
    EXPECT_EQ(direction_and_distance({1.0f, INFINITY, 0.0f}).distance, 0.0f);
    EXPECT_EQ(direction_of(glm::vec3(0.0f), {0.0f, 1.0f, 0.0f}), glm::vec3(0.0f, 1.0f, 0.0f));
}

// One texel by plain integers.
std::int64_t wrapped_index(std::int64_t i, std::int64_t size, std::uint32_t wrap) {
    if (wrap == WrapClamp) return std::min(std::max<std::int64_t>(i, 0), size - 1);
    const std::int64_t period = wrap == WrapRepeat ? size : 2 * size;
    const std::int64_t rest = ((i % period) + period) % period;
    return rest < size ? rest : period - 1 - rest;
}

TEST(TextureNumerics, LookupsMatchDoublePrecisionOverManyRepeats) {
    constexpr std::uint32_t Width = 5, Height = 3;
    std::array<glm::vec3, Width * Height> texels;
    CounterRandom random(5);
    for (glm::vec3& texel : texels) texel = glm::vec3(random.uniform(), random.uniform(), random.uniform());
    for (const std::uint32_t wrap : {WrapRepeat, WrapMirror, WrapClamp}) {
        for (const std::uint32_t filter : {TextureLinear, TextureNearest}) {
            const Texture map{.texels = {reinterpret_cast<const uint*>(texels.data())},
                              .width = Width,
                              .height = Height,
                              .format = TexelRgbFloat,
                              .wrap_s = wrap,
                              .wrap_t = wrap,
                              .texture_filter = filter};
            const auto texel = [&](std::int64_t x, std::int64_t y) {
                return glm::dvec3(texels[static_cast<std::size_t>(wrapped_index(y, Height, wrap) * Width +
                                                                  wrapped_index(x, Width, wrap))]);
            };
            for (int i = 0; i < 20000; ++i) {
                const glm::vec2 uv(12.0 * random.uniform() - 6.0, 12.0 * random.uniform() - 6.0);
                const double x = double(uv.x) * Width, y = double(uv.y) * Height;
                // At the edge of a texel both neighbours are correct.
                if (filter == TextureNearest &&
                    (std::fabs(x - std::round(x)) < 1e-4 || std::fabs(y - std::round(y)) < 1e-4)) {
                    continue;
                }
                const double shift = filter == TextureNearest ? 0.0 : 0.5;
                const double fx = std::floor(x - shift), fy = std::floor(y - shift);
                const double wx = filter == TextureNearest ? 0.0 : x - shift - fx;
                const double wy = filter == TextureNearest ? 0.0 : y - shift - fy;
                const auto ix = static_cast<std::int64_t>(fx), iy = static_cast<std::int64_t>(fy);
                const glm::dvec3 expected =
                    (texel(ix, iy) * (1.0 - wx) + texel(ix + 1, iy) * wx) * (1.0 - wy) +
                    (texel(ix, iy + 1) * (1.0 - wx) + texel(ix + 1, iy + 1) * wx) * wy;
                const glm::dvec3 found = lookup(Scene{}, map, uv);
                ASSERT_LT(glm::length(found - expected), 1e-5)
                    << wrap << " " << filter << " " << uv.x << " " << uv.y;
            }
        }
    }
}

// Next to the poles of a map, where the height of a direction no longer determines its angle accurately.
TEST(SkyNumerics, CoordinatesAndDensitiesNearThePolesMatchDoublePrecision) {
    constexpr std::uint32_t Size = 4;
    std::array<glm::vec3, Size * Size> texels;
    texels.fill(glm::vec3(1.0f));
    std::array<float, Size + Size * Size> sums;  // of the rows, and of the texels of each row: all alike
    for (std::uint32_t i = 0; i < sums.size(); ++i) sums[i] = float(i % Size + 1) / Size;
    const Scene scene{.cdfs = {sums.data()},
                      .environment = {.map = {.texels = {reinterpret_cast<const uint*>(texels.data())},
                                              .width = Size,
                                              .height = Size,
                                              .format = TexelRgbFloat},
                                      .strength = 1.0f,
                                      .row_cdf = 0,
                                      .column_cdf = Size},
                      .features = FeatureEnvironmentMap};
    CounterRandom random(6);
    for (int i = 0; i < 2000; ++i) {
        const double theta = std::pow(10.0, -6.0 * random.uniform()), phi = 2.0 * M_PI * random.uniform();
        const double side = i % 2 == 0 ? 1.0 : -1.0;
        const glm::vec3 direction(std::sin(theta) * std::sin(phi), side * std::cos(theta),
                                  -std::sin(theta) * std::cos(phi));
        const double sine = glm::length(glm::dvec2(direction.x, direction.z));
        const double angle = side > 0.0 ? std::asin(sine) : M_PI - std::asin(sine);
        EXPECT_NEAR(direction_to_uv(direction, scene.environment.rotation).y, angle / M_PI, 2e-7);
        const double expected = 1.0 / (2.0 * M_PI * M_PI * sine);
        EXPECT_NEAR(sky_at(scene, direction).pdf / expected, 1.0, 1e-6) << theta;
    }
}

TEST(TextureNumerics, NonFiniteCoordinatesReturnSomeTexel) {
    const std::array<std::uint32_t, 2> texels{0xff0000ffu, 0xff0000ffu};
    for (const std::uint32_t wrap : {WrapRepeat, WrapMirror, WrapClamp}) {
        const Texture map{.texels = {texels.data()}, .width = 2, .height = 1, .wrap_s = wrap, .wrap_t = wrap};
        for (const float u : {NAN, INFINITY, -INFINITY, 3e38f, -1e12f, -1e-30f, 0.99999994f, 1.0f}) {
            const glm::vec4 found = lookup(Scene{}, map, {u, u});
            EXPECT_NEAR(found.x, 1.0f, 1e-6f) << u;
            EXPECT_EQ(found.y, 0.0f) << u;
        }
    }
}

}  // namespace
}  // namespace tessera::shading
