// Motion blur against closed forms, against averages of still pictures, and in frames of reference in which the
// scene is at rest.
#include <array>
#include <functional>

#include "tests/statistics/model.h"

namespace tessera::embree {
namespace {

using Corners = std::array<glm::vec3, 4>;

glm::dmat4 moved(const glm::dvec3& offset) {
    return glm::translate(glm::dmat4(1.0), offset);
}
glm::dmat4 turned(double angle, const glm::dvec3& axis = {0.0, 0.0, 1.0}) {
    return glm::rotate(glm::dmat4(1.0), angle, axis);
}
// A rotation with enough keys that the chord of each is close to its arc.
std::vector<glm::dmat4> turning(double angle) {
    std::vector<glm::dmat4> steps;
    for (std::size_t i = 1; i <= scene::MaxMotion; ++i) {
        steps.push_back(turned(angle * double(i) / double(scene::MaxMotion)));
    }
    return steps;
}

// Orthographic, 4 m wide, from (0, 0, 5) down.
view::View plan(std::uint32_t size = 32) {
    view::View view = small_view({0, 0, 5}, 1.0, size);
    view.camera = view::pose({.projection = scene::Projection::Orthographic, .orthographic_height = 4.0},
                             moved({0, 0, 5}), 1.0);
    return view;
}

struct Pixels {
    std::vector<double> sum, squares;
    double count = 0;
    double mean(std::size_t i) const { return sum[i] / count; }
    double variance_of_mean(std::size_t i) const {
        return std::max(0.0, squares[i] / count - mean(i) * mean(i)) / count;
    }
};

Pixels pixels_of(const SceneAdapter& world, const view::View& view, std::uint64_t spp) {
    Pixels pixels{std::vector<double>(view.width * view.height),
                  std::vector<double>(view.width * view.height), double(spp)};
    std::size_t at = 0;
    for_samples(world, view, spp, [&](const PathSample& sample) {
        pixels.sum[at] += red(sample);
        pixels.squares[at] += red(sample) * red(sample);
        at = (at + 1) % pixels.sum.size();
    });
    return pixels;
}

// Checks columns of pixels against the fraction of the shutter time in which a lamp of radiance 1 covers them.
void expect_columns(const SceneAdapter& world, const std::function<double(double x)>& fraction) {
    const view::View view = plan();
    constexpr std::uint64_t Spp = 512;
    const Pixels pixels = pixels_of(world, view, Spp);
    double total = 0.0, wanted = 0.0;
    for (std::uint32_t x = 0; x < view.width; ++x) {
        double expected = 0.0, found = 0.0;
        constexpr int Places = 256;
        for (int i = 0; i < Places; ++i) {
            expected += fraction(-2.0 + 4.0 * (x + (i + 0.5) / Places) / view.width) / Places;
        }
        // Rows between -1 and 1: the height of the lamp.
        for (std::uint32_t y = view.height / 4; y < view.height / 4 * 3; ++y) {
            found += pixels.mean(y * view.width + x) / (0.5 * view.height);
        }
        const double n = double(Spp) * 0.5 * view.height;
        // 32 columns are compared: 4 standard errors, fewer with stratification.
        EXPECT_NEAR(found, expected, 4.0 * std::sqrt(expected * (1.0 - expected) / n) + 1e-4) << x;
        total += found;
        wanted += expected;
    }
    EXPECT_NEAR(total / wanted, 1.0, 0.003);
}

// The fraction of time that a lamp of half edge 0.5, moving from -1 to 1 as given by `place`, covers x.
double time_fraction_over(double x, const std::function<double(double)>& place) {
    constexpr int Times = 2000;
    int over = 0;
    for (int i = 0; i < Times; ++i) over += std::fabs(x - place((i + 0.5) / Times)) <= 0.5 ? 1 : 0;
    return double(over) / Times;
}

const Corners Panel{{{-0.5f, -1, 0}, {0.5f, -1, 0}, {0.5f, 1, 0}, {-0.5f, 1, 0}}};
Corners shifted(Corners corners, const glm::vec3& offset) {
    for (glm::vec3& corner : corners) corner += offset;
    return corners;
}

TEST(Motion, AMovingLampIsSpreadEvenlyOverTime) {
    Model model;
    model.placed_at({-1, 0, 0});
    model.moves({moved({2, 0, 0})});
    model.quad(model.material(lamp(1.0f)), Panel);
    expect_columns(model.build(),
                   [](double x) { return time_fraction_over(x, [](double t) { return 2.0 * t - 1.0; }); });
}

TEST(Motion, KeysAreEvenInTime) {
    // Half of the time for the first quarter of the distance.
    Model model;
    model.placed_at({-1, 0, 0});
    model.moves({moved({0.5, 0, 0}), moved({2, 0, 0})});
    model.quad(model.material(lamp(1.0f)), Panel);
    expect_columns(model.build(), [](double x) {
        return time_fraction_over(x, [](double t) { return t < 0.5 ? t - 1.0 : 3.0 * t - 2.0; });
    });
}

TEST(Motion, VertexMotionMatchesTransformMotion) {
    Model model;
    model.deforming_quad(
        model.material(lamp(1.0f)),
        {shifted(Panel, {-1, 0, 0}), shifted(Panel, {-0.5f, 0, 0}), shifted(Panel, {1, 0, 0})});
    expect_columns(model.build(), [](double x) {
        return time_fraction_over(x, [](double t) { return t < 0.5 ? t - 1.0 : 3.0 * t - 2.0; });
    });
}

TEST(Motion, ARotatingShapeIsSpreadOverItsSector) {
    Model model;
    model.moves(turning(0.5 * M_PI));
    // Between the angles 0 and 45 degrees, and the radii 1 and 1.5.
    const float diagonal = std::sqrt(0.5f);
    std::vector<std::array<glm::vec3, 3>> sector;
    for (int i = 0; i < 16; ++i) {
        const auto at = [](int step, float radius) {
            const double angle = 0.25 * M_PI * step / 16.0;
            return glm::vec3(radius * std::cos(angle), radius * std::sin(angle), 0.0);
        };
        sector.push_back({at(i, 1.0f), at(i, 1.5f), at(i + 1, 1.5f)});
        sector.push_back({at(i, 1.0f), at(i + 1, 1.5f), at(i + 1, 1.0f)});
    }
    ASSERT_NEAR(sector.back()[1].x, 1.5f * diagonal, 1e-5f);
    model.triangles(model.material(lamp(1.0f)), sector);
    const SceneAdapter& world = model.build();
    const view::View view = plan(64);
    constexpr std::uint64_t Spp = 64;
    const Pixels pixels = pixels_of(world, view, Spp);
    std::array<double, 12> light{}, expected{}, count{};  // by angle, from -11.25 to 146.25 degrees
    for (std::uint32_t y = 0; y < view.height; ++y) {
        for (std::uint32_t x = 0; x < view.width; ++x) {
            const double px = 4.0 * (x + 0.5) / view.width - 2.0, py = 2.0 - 4.0 * (y + 0.5) / view.height;
            const double radius = std::hypot(px, py), angle = std::atan2(py, px);
            const auto bin = std::size_t((angle / M_PI + 0.0625) * 14.0);
            if (radius < 1.1 || radius > 1.4 || angle < -0.0625 * M_PI || bin >= light.size()) continue;
            light[bin] += pixels.mean(y * view.width + x);
            // The shape begins at the angle a t and ends at 45 degrees + a t: a trapezium over 0, 45, 90, 135.
            const double eighths = angle / (0.25 * M_PI);
            expected[bin] += 0.5 * std::clamp(std::min(eighths, 3.0 - eighths), 0.0, 1.0);
            ++count[bin];
        }
    }
    for (std::size_t bin = 0; bin < light.size(); ++bin) {
        ASSERT_GE(count[bin], 20.0);
        const double fraction = expected[bin] / count[bin];
        // Of 12 bins; and a pixel is evaluated at its center: 1 % of the trapezium's slope in the mean of a bin.
        EXPECT_NEAR(light[bin] / count[bin], fraction,
                    4.0 * std::sqrt(fraction * (1.0 - fraction) / (count[bin] * Spp)) + 0.005)
            << bin;
    }
}

// A floor under a lamp with an occluder in between.
struct RoomMotion {
    std::vector<glm::dmat4> floor, lamp, screen;
};
struct RoomShape {
    Corners lamp{{{-0.5f, -0.5f, 2}, {-0.5f, 0.5f, 2}, {0.5f, 0.5f, 2}, {0.5f, -0.5f, 2}}};
    Corners screen{{{-0.4f, -0.4f, 1}, {0.4f, -0.4f, 1}, {0.4f, 0.4f, 1}, {-0.4f, 0.4f, 1}}};
};
void put_room(Model& model, const RoomMotion& motion, const std::vector<RoomShape>& shapes) {
    std::vector<Corners> lamps, screens;
    for (const RoomShape& shape : shapes) {
        lamps.push_back(shape.lamp);
        screens.push_back(shape.screen);
    }
    model.moves(motion.floor);
    model.floor(model.material(chalk(glm::vec3(0.8f))), 2.0f, 0.0f);
    model.moves(motion.lamp);
    model.deforming_quad(model.material(test::lamp(4.0f)), lamps);
    model.moves(motion.screen);
    model.deforming_quad(model.material(chalk(glm::vec3(0.5f))), screens);
}
view::View room_view() {
    view::View view = small_view({0.5, -3.0, 2.5}, 0.9, 16, turned(0.95, {1.0, 0.0, 0.0}));
    view.max_bounces = 1;
    return view;
}

double red_of(const SceneAdapter& world, const view::View& view, std::uint32_t x, std::uint32_t y,
              std::uint64_t sample) {
    const PathTracer tracer(world.tables(), world.scene(), view);
    std::uint64_t rays = 0;
    return red(tracer.trace(x, y, sample, rays));
}

// The fraction of samples that differ from those of a still scene.
double differing_fraction(const SceneAdapter& world, const view::View& view, const SceneAdapter& still,
                          const view::View& still_view, float tolerance) {
    std::uint64_t count = 0, all = 0;
    for (std::uint64_t sample = 0; sample < 16; ++sample) {
        for (std::uint32_t y = 0; y < view.height; ++y) {
            for (std::uint32_t x = 0; x < view.width; ++x, ++all) {
                const double a = red_of(world, view, x, y, sample),
                             b = red_of(still, still_view, x, y, sample);
                count += std::fabs(a - b) <= tolerance * std::max(1.0, b) ? 0 : 1;
            }
        }
    }
    return double(count) / double(all);
}

// A room at a place that moves as a whole, with the camera.
struct Together {
    Model model;
    view::View view = room_view();

    Together(const glm::dmat4& place, const std::vector<glm::dmat4>& steps) {
        model.set_frame(place);
        put_room(model, {steps, steps, steps}, {RoomShape{}});
        view.camera.world_from_camera = place * view.camera.world_from_camera;
        for (const glm::dmat4& step : steps)
            view.camera.motion.push_back(step * view.camera.world_from_camera);
    }
};

// The picture is that of the still room, shadows included. Rounding moves few samples over an edge.
TEST(Motion, TranslationWithTheCameraIsInvisible) {
    Together still(glm::dmat4(1.0), {});
    const SceneAdapter& calm = still.model.build();
    struct Case {
        glm::dvec3 place;
        std::vector<glm::dmat4> steps;
        float tolerance;
    };
    for (const Case& c :
         {Case{{}, {moved({3, 2, 1})}, 1e-3f}, Case{{}, {moved({3, 2, 1}), moved({-5, 0, 1})}, 1e-3f},
          Case{{}, {moved({1000, 0, 0})}, 0.01f}, Case{{1024.0, -512.0, 768.0}, {moved({3, 2, 1})}, 0.02f}}) {
        SCOPED_TRACE(glm::length(glm::dvec3(c.steps.back()[3])));
        Together moving(moved(c.place), c.steps);
        EXPECT_LT(differing_fraction(moving.model.build(), moving.view, calm, still.view, c.tolerance), 0.01);
    }
}

// The same with rotation, which rotates the samples as well: equal in the mean.
TEST(Motion, RotationWithTheCameraIsInvisible) {
    Together still(glm::dmat4(1.0), {});
    const Mean calm = mean_of(still.model.build(), still.view, 8192, red);
    EXPECT_LE(calm.standard_error / calm.value, 0.003);
    const glm::dmat4 mirror = glm::scale(glm::dmat4(1.0), {-1.0, 1.0, 1.0});
    for (const auto& [place, steps] : {std::pair(glm::dmat4(1.0), turning(1.5)),
                                       std::pair(mirror, std::vector{moved({3, 2, 1}) * turned(0.01)}),
                                       std::pair(turned(2.0, {1, 2, 3}), std::vector{moved({-3, 2, 1})})}) {
        Together moving(place, steps);
        const Mean mean = mean_of(moving.model.build(), moving.view, 8192, red);
        EXPECT_NEAR(mean.value, calm.value, 4.0 * std::hypot(mean.standard_error, calm.standard_error));
    }
}

TEST(Motion, CameraMotionEqualsInverseSceneMotion) {
    const std::vector<glm::dmat4> camera_key_intervals{moved({0.5, 0, 0}), moved({0.5, 0.25, 0.25})};
    std::vector<glm::dmat4> world_steps;
    for (const glm::dmat4& step : camera_key_intervals) world_steps.push_back(moved(-glm::dvec3(step[3])));
    Model still, moving;
    put_room(still, {}, {RoomShape{}});
    put_room(moving, {world_steps, world_steps, world_steps}, {RoomShape{}});
    view::View view = room_view();
    for (const glm::dmat4& step : camera_key_intervals)
        view.camera.motion.push_back(step * view.camera.world_from_camera);
    EXPECT_LT(differing_fraction(moving.build(), room_view(), still.build(), view, 1e-3f), 0.01);
    Model again;
    put_room(again, {}, {RoomShape{}});
    const SceneAdapter& calm = again.build();
    EXPECT_GT(differing_fraction(calm, view, calm, room_view(), 1e-3f), 0.3) << "it does move";
}

// All kinds of motion at once equal the mean of still pictures: a rotating and growing lamp, whose sampling
// density changes, and shadows of deforming meshes.
TEST(Motion, EqualsTheMeanOfStillPictures) {
    RoomShape later;
    later.lamp = shifted({{{-0.25f, -0.5f, 2}, {-0.5f, 0.5f, 2.4f}, {0.75f, 0.75f, 1.7f}, {0.5f, -0.75f, 2}}},
                         {0.5f, 0, 0});
    later.screen = {{{-0.9f, -0.4f, 0.5f}, {0.4f, -0.4f, 1}, {0.1f, 0.7f, 1.2f}, {-0.4f, 0.4f, 1}}};
    const glm::dmat4 screen_end = moved({0.4, 0.2, 0.1}) * turned(0.4), floor_end = moved({0.0, 0.0, 0.25});
    const auto between = [](const auto& a, const auto& b, double fraction) { return a + (b - a) * fraction; };
    view::View view = room_view();
    const glm::dmat4 camera = view.camera.world_from_camera, camera_end = moved({-0.3, 0.1, 0.2}) * camera;

    Model model;
    put_room(model, {{floor_end}, {turned(0.3)}, {screen_end}}, {RoomShape{}, later});
    view::View moving_view = view;
    moving_view.camera.motion = {camera_end};
    const SceneAdapter& world = model.build();
    const Pixels moving = pixels_of(world, moving_view, 4096);

    constexpr int Times = 64;
    std::vector<double> sum(moving.sum.size()), variance(moving.sum.size());
    for (int i = 0; i < Times; ++i) {
        const double t = (i + 0.5) / Times;
        RoomShape shape;
        for (std::size_t corner = 0; corner < 4; ++corner) {
            shape.lamp[corner] += (later.lamp[corner] - shape.lamp[corner]) * float(t);
            shape.screen[corner] += (later.screen[corner] - shape.screen[corner]) * float(t);
        }
        Model still;
        const auto at = [&](const glm::dmat4& end) { return between(glm::dmat4(1.0), end, t); };
        still.moves({});
        const auto put = [&](const glm::dmat4& place, const Corners& corners, ObjectId material) {
            Corners world_corners = corners;
            for (glm::vec3& corner : world_corners) corner = glm::vec3(place * glm::dvec4(corner, 1.0));
            still.quad(material, world_corners);
        };
        put(at(floor_end), {{{-2, -2, 0}, {2, -2, 0}, {2, 2, 0}, {-2, 2, 0}}},
            still.material(chalk(glm::vec3(0.8f))));
        put(at(turned(0.3)), shape.lamp, still.material(lamp(4.0f)));
        put(at(screen_end), shape.screen, still.material(chalk(glm::vec3(0.5f))));
        view.camera.world_from_camera = between(camera, camera_end, t);
        view.seed = 1000 + std::uint64_t(i);
        const Pixels pixels = pixels_of(still.build(), view, 128);
        for (std::size_t p = 0; p < sum.size(); ++p) {
            sum[p] += pixels.mean(p) / Times;
            variance[p] += pixels.variance_of_mean(p) / (Times * Times);
        }
    }
    double all = 0.0, still_all = 0.0, error = 0.0;
    for (std::size_t p = 0; p < sum.size(); ++p) {
        const double variance_of_both = variance[p] + moving.variance_of_mean(p);
        // 256 pixels: a normal deviate beyond 4.5 in one of 600 runs; the seeds are fixed.
        EXPECT_NEAR(moving.mean(p), sum[p], 4.5 * std::sqrt(variance_of_both) + 2e-3) << p;
        all += moving.mean(p);
        still_all += sum[p];
        error += variance_of_both;
    }
    EXPECT_LE(std::sqrt(error) / still_all, 0.003) << "a standard error of 0.3 %";
    EXPECT_NEAR(all / still_all, 1.0, 4.0 * std::sqrt(error) / still_all);
}

TEST(Motion, IdenticalKeysAreNoMotion) {
    Model still, same;
    put_room(still, {}, {RoomShape{}});
    const std::vector<glm::dmat4> identity_keys(3, glm::dmat4(1.0));
    put_room(same, {identity_keys, identity_keys, identity_keys}, {RoomShape{}});
    const SceneAdapter& world = same.build();
    EXPECT_EQ(world.tables().scene.features & shading::FeatureMotion, 0u);
    EXPECT_EQ(differing_fraction(world, room_view(), still.build(), room_view(), 0.0f), 0.0);
}

// A white convex object in a sky of radiance 1: a ray that hits it again from its own surface would change the
// radiance.
TEST(Motion, NoSelfIntersectionOnMovingSurfaces) {
    const glm::dmat4 thin = glm::scale(glm::dmat4(1.0), {1.0, 0.01, 1.0}),
                     mirror = glm::scale(glm::dmat4(1.0), {-1, 1, 1});
    const glm::dmat4 sheared{{1, 0.5, 0, 0}, {0, 1, 0.25, 0}, {0.5, 0, 1, 0}, {0, 0, 0, 1}};
    for (const glm::dmat4& shape : {glm::dmat4(1.0), thin, mirror, sheared}) {
        for (const double away : {0.0, 1e3}) {
            for (const double speed : {0.3, 1e3}) {
                SCOPED_TRACE(testing::Message() << away << " m away, " << speed << " m");
                Model model;
                const glm::dmat4 place = moved({away, 0.3 * away, 0.0});
                const glm::dmat4 end = moved({speed, 0.2 * speed, 0.1}) * turned(0.7);
                model.moves({place * end * glm::inverse(place)});
                model.set_frame(place * shape);
                scene::Material white = chalk(glm::vec3(0.5f));
                model.sphere(model.material(white), {}, 1.0, Normals::Flat, 6);
                model.sky(glm::vec3(1.0f));
                const SceneAdapter& world = model.build();
                view::View view = small_view({away, 0.3 * away, 5.0}, 0.5, 16);
                view.camera.motion = {moved({speed, 0.2 * speed, 0.1}) * view.camera.world_from_camera};
                const PathTracer tracer(world.tables(), world.scene(), view, Strategy::BsdfOnly);
                std::uint64_t rays = 0, seen = 0;
                for (std::uint64_t sample = 0; sample < 64; ++sample) {
                    for (std::uint32_t i = 0; i < 256; ++i) {
                        const PathSample found = tracer.trace(i % 16, i / 16, sample, rays);
                        if (found.object == 0) continue;
                        ++seen;
                        ASSERT_NEAR(red(found), 0.5, 1e-4);
                    }
                }
                EXPECT_GE(seen, 64u);
            }
        }
    }
}

// A moving light: the mean over its positions. A floor below a point at height 1 sees it at x: 1 / (1 +
// x^2)^1.5.
TEST(Motion, MovingLights) {
    Model model;
    model.floor(model.material(chalk(glm::vec3(1.0f))), 20.0f, 0.0f);
    model.moves({moved({4.0, 0, 0})});
    model.point_light({-2.0, 0.0, 1.0}, float(M_PI));
    view::View view = small_view({0, 0, 0.5}, 0.01, 4);
    const Mean mean = mean_of(model.build(), view, 16384, red);
    const double expected = 0.25 * 2.0 * (2.0 / std::sqrt(5.0));  // of (1 + x^2)^-1.5 over -2 .. 2
    EXPECT_LE(mean.standard_error / expected, 0.003);
    EXPECT_NEAR(mean.value, expected, 4.0 * mean.standard_error);
}

}  // namespace
}  // namespace tessera::embree
