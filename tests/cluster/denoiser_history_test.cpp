// A denoiser's history in live views and sequences: every picture continues the one before, whatever nodes render it.
#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <glm/gtc/matrix_transform.hpp>
#include <numeric>

#include "master/filter/catalog.h"
#include "mediator/filter/choice.h"
#include "mediator/filter/inputs.h"
#include "mediator/frame/resolve.h"
#include "mediator/scene/fields.h"
#include "tests/cluster/lit_room.h"
#include "tests/cluster/loopback_cluster.h"

namespace tessera::test {
namespace {

using namespace scene;
using namespace std::chrono_literals;

constexpr std::uint32_t Width = 160, Height = 128;  // 1/8 of it still has coarse pictures

session::ViewRequest request_of(const std::string& filter, std::uint64_t spp) {
    session::ViewRequest request{
        .stop = {.spp = spp}, .picture = session::PictureEncoding::Planes, .film = true};
    request.view.width = Width;
    request.view.height = Height;
    request.view.window = {0, 0, Width, Height};
    request.view.camera = view::perspective(glm::dmat4(1.0), 1.0, double(Width) / Height);
    request.view.channels = {frame::Channel::Radiance};
    request.view.filter = filter;
    request.view.seed = 31;
    return request;
}

// About the vertical axis through the middle of the room.
void turn(view::CameraPose& camera, double degrees) {
    const glm::dvec3 centre(0.0, 0.0, -2.5);
    const glm::dmat4 there = glm::translate(glm::dmat4(1.0), centre);
    camera.world_from_camera = there *
                               glm::rotate(glm::dmat4(1.0), glm::radians(degrees), glm::dvec3(0, 1, 0)) *
                               glm::inverse(there);
}

// The same filter, here, given the films one after another.
class LocalFilter {
  public:
    explicit LocalFilter(const std::string& filter)
        : choice_(filter::parse_choice(filter, filter::catalog()).value()) {}

    std::vector<std::byte> next(const frame::FilmTile& film, view::View view, filter::Changes changes) {
        view.path_class = choice_.entry->description.path_class;
        filter::Inputs inputs = filter::make_inputs(film, view);
        inputs.changes = changes;
        if (!filter_) filter_ = choice_.entry->make(inputs.width, inputs.height);
        filter_->run(inputs, choice_.values, output_, {arena_, {}});
        const auto bytes = std::as_bytes(output_.picture.values());
        return {bytes.begin(), bytes.end()};
    }

  private:
    filter::Choice choice_;
    std::unique_ptr<filter::Filter> filter_;
    filter::Output output_;
    tbb::task_arena arena_{1};
};

double mean(const client::Frame& frame) {
    std::vector<float> values(frame.picture.size() / sizeof(float));
    std::memcpy(values.data(), frame.picture.data(), frame.picture.size());
    return std::accumulate(values.begin(), values.end(), 0.0) / double(values.size());
}

struct DenoiserHistory : testing::Test {
    LoopbackCluster cluster;
    std::shared_ptr<BlobStore> blobs = std::make_shared<BlobStore>();
    std::unique_ptr<client::Session> ann = cluster.member("ann", blobs);
    LitRoom room{*ann, *blobs};

    void SetUp() override {
        cluster.add_node("embree");
        cluster.add_node("embree");
        ASSERT_TRUE(ann->submit(room.entries()).accepted);
    }
    // All pictures up to the last one of the newest revision or version.
    std::vector<client::Frame> frames_after(std::uint64_t revision, Version version) {
        std::vector<client::Frame> frames;
        const auto deadline = std::chrono::steady_clock::now() + 60s;
        while (auto frame = ann->next_frame(deadline, {})) {
            if (frame->revision <= revision && frame->version <= version) continue;
            frames.push_back(std::move(*frame));
            if (frames.back().complete) return frames;
        }
        ADD_FAILURE() << "the picture did not come";
        return frames;
    }
};

// Through a master and two nodes a path of 60 views has the very pictures that the filter makes here of the same films,
// so its error is that of `tessera bench filters`; coarse pictures have histories of their own.
TEST_F(DenoiserHistory, APathOfViewsContinuesItsPictures) {
    LocalFilter whole("psvgf"), coarse("psvgf"), forgetful("psvgf");
    session::ViewRequest request = request_of("psvgf", 1);
    std::uint64_t revision = 0;
    std::size_t coarse_pictures = 0;
    for (int step = 0; step < 60; ++step) {
        turn(request.view.camera, 0.5 * step);
        ann->request_view(1, request);
        const auto frames = frames_after(revision, {~0ull, 0});
        ASSERT_FALSE(frames.empty());
        const client::Frame &first = frames.front(), &last = frames.back();
        ASSERT_TRUE(last.film && first.film) << step;
        revision = last.revision;
        const filter::Changes changes{.film_restarted = true};
        EXPECT_EQ(whole.next(*last.film, request.view, changes), last.picture) << step;
        if (first.scale != 8) continue;  // the watcher was busy
        ++coarse_pictures;
        view::View small = request.view;
        small.width = small.window.width = Width / 8;
        small.height = small.window.height = Height / 8;
        EXPECT_EQ(coarse.next(*first.film, small, changes), first.picture) << step;
    }
    EXPECT_EQ(coarse_pictures, 60u);
}

// Equal random numbers in consecutive films would not average.
TEST_F(DenoiserHistory, FilmsOfALiveViewHaveDifferentNoise) {
    const auto hashes = [&](std::uint64_t number, const std::string& filter) {
        session::ViewRequest request = request_of(filter, 1);
        std::vector<Hash256> found;
        std::uint64_t revision = 0;
        for (const double x : {0.0, 0.1, 0.0}) {
            request.view.camera.world_from_camera[3][0] = x;
            ann->request_view(number, request);
            const client::Frame last = frames_after(revision, {~0ull, 0}).back();
            revision = last.revision;
            found.push_back(last.film_hash);
        }
        ann->close_view(number);
        return found;
    };
    const auto with_history = hashes(1, "psvgf"), without = hashes(2, "fdf");
    EXPECT_NE(with_history[2], with_history[0]) << "the same camera again";
    EXPECT_EQ(without[2], without[0]) << "a filter without history keeps a view's samples";
}

// What pictures after the edit show of the lamp: their difference from pictures of the same films without a history, over
// the light of the lamp.
TEST_F(DenoiserHistory, LightIsGoneThreePicturesAfterItsLamp) {
    ann->request_view(1, request_of("psvgf", 8));
    const client::Frame before = frames_after(0, {~0ull, 0}).back();
    ASSERT_TRUE(ann->submit({room.shine(0, 0.0f)}).accepted);
    const auto frames = frames_after(~0ull, before.version);
    ASSERT_GE(frames.size(), 4u);
    const double light = mean(before) - mean(frames.back());
    ASSERT_GT(light, 0.2 * mean(before));
    for (std::size_t i = 0; i < frames.size(); ++i) {
        view::View view = request_of("psvgf", 8).view;
        view.width = view.window.width = static_cast<std::int32_t>(Width / frames[i].scale);
        view.height = view.window.height = static_cast<std::int32_t>(Height / frames[i].scale);
        client::Frame forgetful = frames[i];
        forgetful.picture = LocalFilter("psvgf").next(*frames[i].film, view, {});
        EXPECT_LT(std::abs(mean(frames[i]) - mean(forgetful)), (i < 2 ? 0.2 : 0.1) * light)
            << "picture " << i + 1 << ", 1/" << frames[i].scale << " of the size";
    }
}

// Frames of a sequence are ends of one view, which edits in between do not render again.
TEST(DenoiserHistoryOfSequences, FramesContinueTheirPictures) {
    LoopbackCluster cluster;
    cluster.add_node("embree");
    cluster.add_node("embree");
    const auto blobs = std::make_shared<BlobStore>();
    const auto session = cluster.batch(blobs);
    const auto units = [&] { return cluster.session(blobs)->status().units.issued; };
    session::ViewRequest request = request_of("psvgf", 2);
    LocalFilter local("psvgf");
    std::uint64_t issued = 0;
    for (std::uint64_t frame = 0; frame < 4; ++frame) {
        filter::Changes changes{.film_restarted = frame > 0};
        if (frame == 2) {
            session->refresh();
            const auto& objects = session->scene().objects();
            const auto material = std::ranges::find_if(
                objects, [](const auto& entry) { return std::holds_alternative<Material>(*entry.second); });
            ASSERT_NE(material, objects.end());
            ASSERT_TRUE(session
                            ->submit({Update{material->first, Fields<Material>(&Material::emission).bits(),
                                             Material{.emission = glm::vec3(3.0f)}}})
                            .accepted);
            changes.lights_or_materials = true;
        }
        if (frame > 0) EXPECT_EQ(units(), issued) << "rendered between frames";
        request.view.seed = 7 + frame;
        turn(request.view.camera, 0.5 * double(frame));
        const auto made = client::render(*session, request, {}, {}, client::Session::AfterEnd::Keep);
        ASSERT_EQ(made.summary.outcome, session::Outcome::Complete) << made.summary.message;
        EXPECT_EQ(made.summary.seed, 7 + frame);
        EXPECT_EQ(made.frame.picture, local.next(*made.film(), request.view, changes)) << frame;
        issued = units();
    }
    const auto last = client::render(*session, request, {}, {});  // the same request: the same view again
    LocalFilter forgetful("psvgf");
    const auto alone = client::render(*session, request, {}, {});
    EXPECT_EQ(alone.frame.picture, forgetful.next(*alone.film(), request.view, {})) << "closed in between";
}

}  // namespace
}  // namespace tessera::test
