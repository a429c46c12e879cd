// How the time of filters depends on the picture, by CPU time of one thread: absolute times are for GPUs in the theses.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "master/filter/catalog.h"
#include "mediator/filter/choice.h"
#include "tests/filter/planes_scene.h"
#include "tests/support/cpu_time.h"

namespace tessera::filter {
namespace {

// The shortest CPU time of some frames, one after the other, and of the passes whose names begin with `passes`.
class TimedFrames {
  public:
    TimedFrames(const std::string& choice, std::vector<Inputs> frames, std::string_view passes = {})
        : choice_(parse_choice(choice, catalog()).value()),
          filter_(choice_.entry->make(0, 0)),
          frames_(std::move(frames)),
          passes_(passes) {}

    // All frames once. The first time is not counted: it allocates and has no history.
    void run() {
        for (const Inputs& inputs : frames_) {
            const double start = test::thread_cpu_seconds();
            const Report report = filter_->run(inputs, choice_.values, out_, {arena_, {}});
            const double now = test::thread_cpu_seconds() - start;
            if (!warm_) continue;
            seconds = std::min(seconds, now);
            for (const Pass& pass : report.passes) {
                if (!pass.name.starts_with(passes_)) continue;
                const auto [known, is_new] = shortest_.try_emplace(pass.name, tessera::seconds(pass.time));
                if (!is_new) known->second = std::min(known->second, tessera::seconds(pass.time));
            }
        }
        warm_ = true;
    }
    double pixels() const { return double(frames_.front().pixel_count()); }
    // Times of passes are by the clock, so that each of them has its shortest.
    double pass_seconds() const {
        double sum = 0.0;
        for (const auto& [name, time] : shortest_) sum += time;
        return sum;
    }

    double seconds = 1e9;  // of a frame

  private:
    Choice choice_;
    std::unique_ptr<Filter> filter_;
    std::vector<Inputs> frames_;
    std::string_view passes_;
    tbb::task_arena arena_{1};  // the calling thread
    Output out_;
    std::map<std::string_view, double> shortest_;  // by pass
    bool warm_ = false;
};

// In turn, so that a slower machine is slower for all of them.
void measure(std::vector<TimedFrames>& subjects, int repetitions) {
    for (int i = 0; i <= repetitions; ++i) {
        for (TimedFrames& subject : subjects) subject.run();
    }
}

// Of the least squares line of seconds over pixels.
double coefficient_of_determination(const std::vector<TimedFrames>& subjects) {
    const double n = double(subjects.size());
    double x = 0.0, y = 0.0, xx = 0.0, xy = 0.0, yy = 0.0;
    for (const TimedFrames& subject : subjects) {
        x += subject.pixels() / n;
        y += subject.seconds / n;
    }
    for (const TimedFrames& subject : subjects) {
        const double dx = subject.pixels() - x, dy = subject.seconds - y;
        xx += dx * dx;
        xy += dx * dy;
        yy += dy * dy;
    }
    return xy * xy / (xx * yy);
}

std::vector<TimedFrames> of_four_sizes(const std::string& choice, const auto& frames) {
    std::vector<TimedFrames> subjects;
    for (const std::uint32_t k : {2u, 3u, 4u, 5u}) subjects.emplace_back(choice, frames(96 * k, 54 * k));
    return subjects;
}

// R^2 over 0.99, and the time of a pixel the same within `tolerance`.
void expect_linear(const std::vector<TimedFrames>& subjects, double tolerance) {
    EXPECT_GT(coefficient_of_determination(subjects), 0.99);
    double least = 1e9, most = 0.0;
    for (const TimedFrames& subject : subjects) {
        const double per_pixel = subject.seconds / subject.pixels();
        least = std::min(least, per_pixel);
        most = std::max(most, per_pixel);
    }
    EXPECT_LT(most / least, 1.0 + tolerance) << 1e9 * least << " to " << 1e9 * most << " ns per pixel";
}

enum class Camera { Still, Moving };

// Two films of one sample, to be used in turn.
std::vector<Inputs> psvgf_frames(std::uint32_t width, std::uint32_t height, Camera camera,
                                 double coverage = 1.0, const PlanesScene& scene = {}) {
    std::vector<Inputs> frames;
    for (std::uint64_t i = 0; i < 2; ++i) {
        const double step = camera == Camera::Moving ? 0.05 * double(i) : 0.0;
        const auto pose = looking_at(scene, {step, 0.0, 0.0}, width, height, 0.2 * step);
        frames.push_back(
            photograph(scene, pose, {.width = width, .height = height, .seed = i + 1, .coverage = coverage}));
        frames.back().changes.film_restarted = true;
    }
    return frames;
}

TEST(PsvgfSpeed, IsLinearInThePixels) {  // DT28
    auto subjects = of_four_sizes("psvgf:blend=off", [](std::uint32_t width, std::uint32_t height) {
        return psvgf_frames(width, height, Camera::Moving);
    });
    measure(subjects, 20);
    expect_linear(subjects, 0.6);  // a small picture stays in the cache from stage to stage
}

// Stages between the scenes of one camera, as the thesis has it. A moving camera costs more on a CPU, which skips the
// spatial variance in rows that are nowhere young, and copies the history of a still picture.
TEST(PsvgfSpeed, HardlyDependsOnSceneAndCamera) {  // DT28
    PlanesScene wall, tilted;
    wall.board_half = 0.0;
    wall.textured = false;
    tilted.tilt = 3.0;
    std::vector<TimedFrames> subjects;
    for (const Camera camera : {Camera::Still, Camera::Moving}) {
        for (const PlanesScene& scene : {PlanesScene{}, wall, tilted}) {
            subjects.emplace_back("psvgf:blend=off", psvgf_frames(320, 180, camera, 1.0, scene), "wavelet");
        }
    }
    measure(subjects, 16);
    for (std::size_t i = 0; i < subjects.size(); ++i) {
        const std::size_t first = i / 3 * 3;  // of the same camera
        EXPECT_NEAR(subjects[i].seconds / subjects[first].seconds, 1.0, 0.2) << i;
        const double of_still = i < 3 ? 1.0 : 1.4;
        EXPECT_NEAR(subjects[i].seconds / subjects[i % 3].seconds, of_still, 0.3) << i;
        EXPECT_NEAR(subjects[i].pass_seconds() / subjects[0].pass_seconds(), 1.0, 0.25) << i;
        // On the GPUs of the thesis the wavelet takes 56 to 74 %. Here it is vectorised, lookups at any place of the
        // history are not.
        EXPECT_GT(subjects[i].pass_seconds(), 0.2 * subjects[i].seconds) << i;
    }
}

TEST(PsvgfSpeed, FillingHolesCostsLessThanTheRest) {  // DT29
    std::vector<TimedFrames> subjects;
    for (const Camera camera : {Camera::Still, Camera::Moving}) {
        for (const double coverage : {1.0, 0.3}) {
            subjects.emplace_back("psvgf:blend=off", psvgf_frames(320, 180, camera, coverage), "holes");
        }
    }
    measure(subjects, 20);
    for (const std::size_t full : {0, 2}) {
        EXPECT_EQ(subjects[full].pass_seconds(), 0.0);
        EXPECT_GT(subjects[full + 1].pass_seconds(), 0.0);
        EXPECT_LT(subjects[full + 1].pass_seconds(), 0.6 * subjects[full].seconds);
    }
    // With all that follows from few samples: young pixels take the spatial variance as well. No sample is scattered
    // forward, so that motion does not add to it.
    EXPECT_LT(subjects[1].seconds, 2.0 * subjects[0].seconds);
    EXPECT_LT(subjects[3].seconds, 1.6 * subjects[2].seconds);
}

TEST(PsvgfSpeed, SixLevelsOf3x3AreFasterThanFiveOf5x5) {  // DT30
    std::vector<TimedFrames> subjects;
    for (const char* how : {"psvgf:blend=off", "psvgf:blend=off,kernel=5x5,levels=5,order=fine"}) {
        subjects.emplace_back(how, psvgf_frames(320, 180, Camera::Moving), "wavelet");
    }
    measure(subjects, 6);
    EXPECT_LT(subjects[0].pass_seconds(), 0.7 * subjects[1].pass_seconds());
}

// It takes 1.05 times as long as the six levels of wavelets, which are vectorised; with scalar loops it took 1.8 times.
TEST(ConvergenceBlendSpeed, IsThatOfVectorisedLoops) {
    constexpr std::uint32_t Width = 640, Height = 360;
    const std::vector frames{synthetic_inputs(
        Width, Height, 4, [=](auto x, auto y, auto i) { return shadowed_texture(Width, Height, x, y, i); })};
    std::vector<TimedFrames> subjects;
    for (const char* passes : {"convergence blend", "wavelet"})
        subjects.emplace_back("psvgf", frames, passes);
    measure(subjects, 16);
    EXPECT_GT(subjects[0].pass_seconds(), 0.0);
    EXPECT_LT(subjects[0].pass_seconds(), 1.35 * subjects[1].pass_seconds());
}

// 5.7 times on an idle machine, less for caches that are shared with others.
TEST(PixelSpeed, SeparableIsFiveTimesFasterThanBruteForce) {
    constexpr std::uint32_t Size = 192;
    const std::vector frames{synthetic_inputs(
        Size, Size, 4, [=](auto x, auto y, auto i) { return shadowed_texture(Size, Size, x, y, i); })};
    std::vector<TimedFrames> subjects;
    for (const char* how : {"pixel:method=brute,adaptive=off,blend=off", "pixel:adaptive=off,blend=off"})
        subjects.emplace_back(how, frames);
    measure(subjects, 25);
    EXPECT_GT(subjects[0].seconds, 5.0 * subjects[1].seconds);
}

TEST(FdfSpeed, IsLinearInThePixels) {  // LT22
    auto subjects = of_four_sizes("fdf:blend=off", [](std::uint32_t width, std::uint32_t height) {
        return std::vector{synthetic_inputs(width, height, 4, [=](auto x, auto y, auto i) {
            return shadowed_texture(width, height, x, y, i);
        })};
    });
    measure(subjects, 16);
    expect_linear(subjects, 0.2);
}

}  // namespace
}  // namespace tessera::filter
