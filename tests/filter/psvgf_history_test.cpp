// Progressive SVGF after restarted films: which history is kept, reprojected and dropped.
#include <gtest/gtest.h>

#include <cmath>

#include "mediator/base/random.h"
#include "tests/filter/psvgf_session.h"

namespace tessera::filter {
namespace {

TEST(PsvgfHistory, IsTheMeanOfAllFramesWithoutALeastShare) {  // DT2
    const PlanesScene scene = wall_alone();
    const auto camera = looking_at(scene, {}, Width, Height);
    Session session(Raw + "r0=0");
    std::vector<double> sums(Width * Height);
    constexpr int Frames = 20;
    for (int k = 0; k < Frames; ++k) {
        const Inputs frame = photograph(scene, camera, {.seed = std::uint64_t(k)});
        for (std::size_t i = 0; i < sums.size(); ++i) {
            sums[i] += frame.mean(frame::Channel::Irradiance).plane(0)[i];
        }
        session.restart(frame);
    }
    for (std::size_t i = 0; i < sums.size(); ++i) {
        EXPECT_NEAR(session.map("irradiance").plane(0)[i], sums[i] / Frames, 1e-5 * sums[i] + 1e-6);
        EXPECT_NEAR(session.map("age").plane(0)[i], Frames, 1e-4);
    }
}

TEST(PsvgfHistory, ManySamplesInOneFrameAreManyFrames) {  // DT25
    const PlanesScene scene = wall_alone();
    const auto camera = looking_at(scene, {}, Width, Height);
    // The same eight samples in both.
    const Inputs whole = photograph(scene, camera, {.n = 8, .seed = 3});
    Session at_once(Raw + "r0=0"), one_by_one(Raw + "r0=0");
    at_once.restart(whole);
    std::vector<Inputs> frames;
    for (std::uint64_t i = 0; i < 8; ++i) {
        frames.push_back(synthetic_inputs(Width, Height, 1, [&](auto x, auto y, auto) {
            CounterRandom random(mix(3), mix((std::uint64_t{y} << 32 | x) ^ mix(i)));
            const auto hit = scene.trace(camera, Width, Height, x + 0.5, y + 0.5);
            SyntheticSample s;
            const float light = random.uniform() < hit->chance ? 1.0f : 0.0f;
            s.albedo.fill(hit->albedo);
            s.irradiance.fill(light);
            s.high.fill(light * hit->albedo);
            s.depth = static_cast<float>(hit->depth);
            return s;
        }));
        frames.back().camera = camera;
        frames.back().path_class = view::PathClass::Diffuse;
        one_by_one.restart(frames.back());
    }
    for (const char* map : {"irradiance", "deviation", "age"}) {
        EXPECT_LT(largest_difference(at_once.map(map), one_by_one.map(map)), 2e-5) << map;
    }
}

TEST(PsvgfHistory, LeastShareIsAnExponentialMean) {  // DT3, DT4
    const PlanesScene scene = wall_alone();
    const auto camera = looking_at(scene, {}, Width, Height);
    Session session(Raw + "r0=0.2");
    const std::array<float, 6> ages{1, 2, 3, 4, 5, 5};  // n / r with r = 1, 1/2, 1/3, 1/4, 0.2, 0.2
    double sum = 0.0;
    int measured = 0;
    for (int k = 0; k < 48; ++k) {
        session.restart(photograph(scene, camera, {.seed = std::uint64_t(k)}));
        if (k < 6) {
            EXPECT_NEAR(session.age(40, 30), ages[std::size_t(k)], 1e-4) << k;
        }
        if (k >= 24 && k % 8 == 0) {
            sum += variance_of(session.map("irradiance"));
            ++measured;
        }
    }
    EXPECT_NEAR(sum / measured / 0.25, 0.2 / 1.8, 0.05 * 0.2 / 1.8);  // r / (2 - r) of p (1 - p)
}

TEST(PsvgfHistory, MomentsAreThoseOfTheSamples) {  // DT5
    const PlanesScene scene = wall_alone();
    const auto camera = looking_at(scene, {}, Width, Height);
    Session plain(Raw + "r0=0,mode=svgf"), fed("blend=off,taa=off,feedback=1000,r0=0,mode=svgf");
    for (int k = 0; k < 32; ++k) {
        const Inputs frame = photograph(scene, camera, {.seed = std::uint64_t(k)});
        plain.restart(frame);
        fed.restart(frame);
    }
    double sum = 0.0;
    for (const float deviation : plain.map("deviation").values()) sum += double(deviation) * deviation;
    EXPECT_NEAR(sum / (Width * Height), 0.25, 0.25 * 0.01);
    EXPECT_EQ(largest_difference(plain.map("deviation"), fed.map("deviation")), 0.0);
    EXPECT_GT(largest_difference(plain.map("irradiance"), fed.map("irradiance")), 0.0);
}

TEST(PsvgfHistory, NeverCountsASampleTwice) {
    const PlanesScene scene = wall_alone();
    const auto camera = looking_at(scene, {}, Width, Height);
    Session direct(Raw + "r0=0"), step_by_step(Raw + "r0=0");
    for (Session* session : {&direct, &step_by_step}) {
        session->restart(photograph(scene, camera, {.n = 4, .seed = 1}));
    }
    direct.restart(photograph(scene, camera, {.n = 6, .seed = 2}));
    step_by_step.restart(photograph(scene, camera, {.n = 1, .seed = 2}));
    step_by_step.run(photograph(scene, camera, {.n = 3, .seed = 2}));
    step_by_step.run(photograph(scene, camera, {.n = 6, .seed = 2}));
    EXPECT_NEAR(step_by_step.age(10, 10), 10.0f, 1e-4);
    EXPECT_EQ(largest_difference(direct.map("irradiance"), step_by_step.map("irradiance")), 0.0);
}

TEST(PsvgfHistory, AGrowingFilmReplacesTheHistory) {
    PlanesScene scene = wall_alone();
    const auto camera = looking_at(scene, {}, Width, Height);
    const Inputs last = photograph(scene, camera, {.n = 256, .seed = 2});
    Session session("");
    scene.strength = 4.0f;  // the history is wrong, without a reported change
    session.restart(photograph(scene, camera, {.n = 64, .seed = 1}));
    session.restart(last);
    Session fresh("");
    EXPECT_LT(largest_difference(session.run(last).picture, fresh.run(last).picture), 1e-6);
}

// A frame in which `only` has a sample.
Inputs single_sample(const PlanesScene& scene, const view::CameraPose& camera, std::size_t only) {
    const Inputs full = photograph(scene, camera, {.seed = 2});
    Inputs frame = photograph(scene, camera, {.seed = 2, .coverage = 0.0});
    frame.counts.plane(0)[only] = 1.0f;
    frame.object_ids[only] = full.object_ids[only];
    for (std::size_t channel = 0; channel < frame::ChannelCount; ++channel) {
        for (std::uint32_t c = 0; c < frame.means[channel].components(); ++c) {
            frame.means[channel].plane(c)[only] = full.means[channel].plane(c)[only];
        }
    }
    return frame;
}

TEST(PsvgfHistory, HolesKeepIt) {
    const PlanesScene scene = wall_alone();
    const auto camera = looking_at(scene, {}, Width, Height);
    Session session(Raw + "r0=0");
    session.restart(photograph(scene, camera, {.n = 16, .seed = 1}));
    const Planes kept = session.map("irradiance");
    session.restart(single_sample(scene, camera, 5));
    EXPECT_NEAR(session.map("age").plane(0)[5], 17.0f, 1e-4);
    EXPECT_EQ(session.map("age").plane(0)[6], 16.0f);
    EXPECT_EQ(session.map("irradiance").plane(0)[6], kept.plane(0)[6]);
    EXPECT_EQ(session.map("irradiance").plane(0)[Width * Height - 1], kept.plane(0)[Width * Height - 1]);
}

TEST(PsvgfHistory, AFilmWithoutSamplesChangesNothing) {
    const PlanesScene scene = wall_alone();
    const auto camera = looking_at(scene, {}, Width, Height);
    Session session(Raw + "r0=0"), other(Raw + "r0=0");
    for (Session* s : {&session, &other}) s->restart(photograph(scene, camera, {.n = 4, .seed = 1}));
    const Planes before = other.run(photograph(scene, camera, {.n = 4, .seed = 1})).picture;
    const Output& nothing = session.restart(photograph(scene, camera, {.n = 4, .coverage = 0.0}));
    EXPECT_EQ(largest_difference(nothing.picture, before), 0.0);
    ASSERT_FALSE(session.report().notes.empty());
    session.run(photograph(scene, camera, {.n = 4, .seed = 2}));
    other.restart(photograph(scene, camera, {.n = 4, .seed = 2}));
    EXPECT_EQ(largest_difference(session.map("irradiance"), other.map("irradiance")), 0.0);
    EXPECT_NEAR(session.age(3, 3), 8.0f, 1e-4);
}

TEST(PsvgfHistory, AStoppedRunKeepsThePreviousState) {
    const PlanesScene scene = wall_alone();
    const auto camera = looking_at(scene, {}, Width, Height);
    const auto filter = psvgf().make(Width, Height);
    const Choice choice = parse_choice("psvgf:" + Raw + "r0=0", catalog()).value();
    tbb::task_arena arena(2);
    Output out;
    out.wants_maps = true;
    const auto run = [&](std::uint64_t seed, std::stop_token stop) {
        Inputs inputs = photograph(scene, camera, {.n = 4, .seed = seed});
        inputs.changes.film_restarted = true;
        return filter->run(inputs, choice.values, out, {arena, stop});
    };
    std::stop_source stopped;
    stopped.request_stop();
    EXPECT_FALSE(run(1, {}).stopped);
    EXPECT_TRUE(run(2, stopped.get_token()).stopped);
    EXPECT_FALSE(run(3, {}).stopped);
    EXPECT_NEAR(out.maps.back().planes.plane(0)[0], 8.0f, 1e-4);
}

TEST(PsvgfHistory, FeedbackWaitsForOneWholeSample) {  // DT24
    const PlanesScene scene = wall_alone();
    const auto camera = looking_at(scene, {}, Width, Height);
    const std::string how = "blend=off,taa=off,r0=0,";
    Session fed(how + "feedback=100"), raw(how + "feedback=0");
    int first_difference = 0;
    for (int k = 1; k <= 8; ++k) {
        const Inputs frame = photograph(scene, camera, {.seed = std::uint64_t(k), .coverage = 0.3});
        fed.restart(frame);
        raw.restart(frame);
        if (first_difference == 0 && largest_difference(fed.map("irradiance"), raw.map("irradiance")) > 0.0) {
            first_difference = k;
        }
    }
    EXPECT_EQ(first_difference, 5);  // 0.3 k >= 1 at k = 4: the feedback is visible in the next frame
}

// A step of light at x = 0 of the wall, before and after its edge moved.
double shadow_error(Session& session, const PlanesScene& scene, const view::CameraPose& camera) {
    const Planes truth = truth_of(scene, camera, Width, Height);
    double error = 0.0, power = 0.0;
    for (std::uint32_t y = 0; y < Height; ++y) {
        for (std::uint32_t x = 0; x < Width; ++x) {
            const auto hit = scene.trace(camera, Width, Height, x + 0.5, y + 0.5);
            const double e = session.map("irradiance").row(0, y)[x], t = hit->chance * scene.strength;
            error += std::abs(e - t);
            power += t;
        }
    }
    return error / power;
}

TEST(PsvgfHistory, ChangedLightShortensTheHistory) {  // DT31
    PlanesScene scene = wall_alone();
    const auto camera = looking_at(scene, {}, Width, Height);
    scene.shadow_x = -1.5;
    PlanesScene moved = scene;
    moved.shadow_x = 1.5;
    const Changes light{.lights_or_materials = true};
    Session tested("taa=off"), blind("taa=off,light_test=0,light_history=1");
    for (Session* session : {&tested, &blind}) {
        session->restart(photograph(scene, camera, {.n = 64, .seed = 1}));
        for (std::uint64_t k = 0; k < 3; ++k) {
            session->restart(photograph(moved, camera, {.n = 4, .seed = 10 + k}), k == 0 ? light : Changes{});
        }
    }
    const double error = shadow_error(tested, moved, camera);
    EXPECT_LT(error, 0.1);
    EXPECT_LT(error, 0.5 * shadow_error(blind, moved, camera));
    // Without a change no history is distrusted.
    Session still("taa=off,r0=0");
    still.restart(photograph(scene, camera, {.n = 64, .seed = 1}));
    still.restart(photograph(scene, camera, {.n = 4, .seed = 20}), light);
    double age = mean_of(still.map("age"));
    EXPECT_GT(age, 0.7 * (0.25 * 64 + 4));
}

// With one sample a pixel, 3x3 pixels do not show that half of the light went.
TEST(PsvgfHistory, DimmedLightIsGoneWithOneSampleAPixel) {
    PlanesScene scene = wall_alone();
    const auto camera = looking_at(scene, {}, Width, Height);
    PlanesScene dimmed = scene;
    dimmed.strength *= 0.5;
    Session session(Raw);
    session.restart(photograph(scene, camera, {.n = 8, .seed = 1}));
    const double before = mean_of(session.map("irradiance"));
    session.restart(photograph(dimmed, camera, {.n = 1, .seed = 2}), {.lights_or_materials = true});
    const double after = mean_of(session.map("irradiance"));
    const double light = 0.5 * before;  // that went
    EXPECT_LT(after - (before - light), 0.1 * light);
}

TEST(PsvgfHistory, ChangedGeometryIsDroppedWhereItChanged) {
    PlanesScene scene;
    const auto camera = looking_at(scene, {}, Width, Height);
    PlanesScene moved = scene;
    moved.board_x = 1.2;
    Session session(Raw + "r0=0,light_test=0");
    session.restart(photograph(scene, camera, {.n = 16, .seed = 1}));
    session.restart(photograph(moved, camera, {.n = 1, .seed = 2}), {.geometry = true});
    for (std::uint32_t y = 0; y < Height; ++y) {
        for (std::uint32_t x = 0; x < Width; ++x) {
            const auto was = scene.trace(camera, Width, Height, x + 0.5, y + 0.5);
            const auto is = moved.trace(camera, Width, Height, x + 0.5, y + 0.5);
            EXPECT_NEAR(session.age(x, y), was->object == is->object ? 17.0f : 1.0f, 1e-3) << x << " " << y;
        }
    }
}

// A view may show other objects without an edit of the scene, as with another set of object layers.
TEST(PsvgfHistory, OtherObjectsInAStillPictureDropIt) {
    const PlanesScene scene;
    const auto camera = looking_at(scene, {}, Width, Height);
    const Inputs before = photograph(scene, camera, {.n = 16, .seed = 1}),
                 after = photograph(wall_alone(), camera, {.n = 1, .seed = 2});
    Session session(Raw + "r0=0");
    session.restart(before);
    session.restart(after);
    const auto same_around = [&](std::uint32_t x, std::uint32_t y) {
        for (std::uint32_t ty = y - 1; ty <= y + 1; ++ty) {
            for (std::uint32_t tx = x - 1; tx <= x + 1; ++tx) {
                const std::size_t i = std::size_t{ty} * Width + tx;
                if (before.object_ids[i] == after.object_ids[i]) return true;
            }
        }
        return false;
    };
    std::size_t dropped = 0;
    for (std::uint32_t y = 1; y + 1 < Height; ++y) {
        for (std::uint32_t x = 1; x + 1 < Width; ++x) {
            if (same_around(x, y)) continue;
            ++dropped;
            EXPECT_EQ(session.age(x, y), 1.0f) << x << " " << y;
        }
    }
    EXPECT_GT(dropped, 100u);
}

// Pixels of two surfaces whose samples see either: light, alpha and what is not diffuse.
TEST(PsvgfHistory, OfAStillPictureIsThatOfItsPixels) {
    constexpr std::uint32_t Size = 16, Frames = 12;
    Session session(Raw + "r0=0");
    Planes sum(Size, Size, 4), picture;
    for (std::uint32_t frame = 0; frame < Frames; ++frame) {
        Inputs inputs = synthetic_inputs(Size, Size, 1, [&](auto x, auto y, auto) {
            const bool front =
                x < 6 || (x == 6 && CounterRandom(frame, std::uint64_t{y} << 32 | x).uniform() < 0.4);
            SyntheticSample s;
            s.albedo.fill(front ? 0.9f : 0.1f);
            s.irradiance.fill(front ? 0.5f : 4.0f);
            s.high.fill(front ? 0.45f : 0.4f);
            s.low.fill(front ? 0.0f : 2.0f);
            s.alpha = front ? 1.0f : 0.25f;
            s.depth = front ? 1.0f : 3.0f;
            s.object = front ? 1 : 2;
            return s;
        });
        inputs.path_class = view::PathClass::Diffuse;
        for (std::uint32_t c = 0; c < 4; ++c) {
            for (std::size_t i = 0; i < sum.pixel_count(); ++i)
                sum.plane(c)[i] += inputs.color(c)[i] / float(Frames);
        }
        picture = session.restart(inputs).picture;
    }
    for (std::uint32_t y = 1; y + 1 < Size; ++y) {
        for (std::uint32_t x = 0; x < Size; ++x) {
            for (std::uint32_t c = 0; c < 4; ++c)
                EXPECT_NEAR(picture.row(c, y)[x], sum.row(c, y)[x], 2e-4f) << x << " " << y;
        }
    }
}

TEST(PsvgfHistory, ResetForgets) {
    const PlanesScene scene = wall_alone();
    const auto camera = looking_at(scene, {}, Width, Height);
    const auto filter = psvgf().make(Width, Height);
    tbb::task_arena arena(2);
    Output out, alone;
    Inputs second = photograph(scene, camera, {.n = 4, .seed = 2});
    second.changes.film_restarted = true;
    const Values values = default_values(psvgf().description);
    filter->run(photograph(scene, camera, {.n = 64, .seed = 1}), values, out, {arena, {}});
    filter->reset();
    filter->run(second, values, out, {arena, {}});
    psvgf().make(Width, Height)->run(second, values, alone, {arena, {}});
    EXPECT_EQ(largest_difference(out.picture, alone.picture), 0.0);
}

}  // namespace
}  // namespace tessera::filter
