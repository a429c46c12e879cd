// Pictures that the master filters: the same bits for any cluster, and on time.
#include <gtest/gtest.h>

#include <cstring>

#include "master/filter/catalog.h"
#include "mediator/filter/choice.h"
#include "mediator/filter/inputs.h"
#include "mediator/frame/resolve.h"
#include "tests/cluster/cluster_scene.h"
#include "tests/cluster/loopback_cluster.h"

namespace tessera::test {
namespace {

using session::PictureEncoding;
using session::Policy;
using namespace std::chrono_literals;

session::ViewRequest picture_request(const std::string& filter, Policy policy = Policy::Mixed) {
    session::ViewRequest request{.stop = {.spp = 6},
                                 .policy = policy,
                                 .min_nodes = 1,
                                 .wait_limit = 60s,
                                 .picture = PictureEncoding::Planes};
    request.view.width = 90;
    request.view.height = 60;
    request.view.window = {0, 0, 90, 60};
    request.view.camera = view::perspective(glm::dmat4(1.0), 0.8, 1.5);
    request.view.channels = {frame::Channel::Radiance};
    request.view.filter = filter;
    return request;
}

client::ViewResult render(int nodes, const session::ViewRequest& request, Duration cost = {}, int times = 1) {
    LoopbackCluster cluster;
    for (int i = 0; i < nodes; ++i) cluster.add_node("null", {}, cost);
    auto blobs = std::make_shared<scene::BlobStore>();
    const auto session = cluster.batch(blobs);
    client::ViewResult result;
    for (int i = 0; i < times; ++i) result = client::render(*session, request, {}, {});
    return result;
}

class FilteredPicture : public testing::TestWithParam<std::string> {};

TEST_P(FilteredPicture, HasTheSameBitsForAnyCluster) {
    const client::ViewResult one = render(1, picture_request(GetParam(), Policy::Tiled));
    ASSERT_EQ(one.summary.outcome, session::Outcome::Complete) << one.summary.message;
    ASSERT_TRUE(one.has_picture());
    EXPECT_EQ(one.summary.picture.filter, GetParam());
    EXPECT_EQ(one.frame.picture.size(), std::size_t{90} * 60 * 3 * sizeof(float));
    EXPECT_FALSE(one.film()) << "it was not requested";
    EXPECT_EQ(one.summary.min_samples, 6u);
    EXPECT_EQ(one.summary.max_samples, 6u);
    session::ViewRequest three = picture_request(GetParam(), Policy::Cooperative);
    three.min_nodes = 3;
    EXPECT_EQ(render(3, three).frame.picture, one.frame.picture);
}

// The picture received is the one that a local filter makes of the same film.
TEST_P(FilteredPicture, IsMadeOfItsFilm) {
    session::ViewRequest request = picture_request(GetParam());
    request.film = true;
    const client::ViewResult result = render(2, request);
    ASSERT_TRUE(result.film() && result.has_picture()) << result.summary.message;
    const auto choice = filter::parse_choice(GetParam(), filter::catalog());
    view::View view = request.view;
    view.path_class = choice->entry->description.path_class;
    const filter::Inputs inputs = filter::make_inputs(*result.film(), view);
    filter::Output output;
    tbb::task_arena arena(1);
    choice->entry->make(90, 60)->run(inputs, choice->values, output, {arena, {}});
    const auto values = output.picture.values();
    ASSERT_EQ(values.size_bytes(), result.frame.picture.size());
    EXPECT_EQ(std::memcmp(values.data(), result.frame.picture.data(), values.size_bytes()), 0);
}

std::vector<std::string> filter_names() {
    std::vector<std::string> names;
    for (const auto& entry : filter::catalog()) names.emplace_back(entry.description.name);
    return names;
}
INSTANTIATE_TEST_SUITE_P(Filters, FilteredPicture, testing::ValuesIn(filter_names()));

TEST(PictureRequest, InvalidRequestsAreRefusedWithAReason) {
    const auto message = [](auto change) {
        session::ViewRequest request = picture_request("gauss");
        change(request);
        try {
            (void)render(1, request);
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::Refused);
            return std::string(error.what());
        }
        ADD_FAILURE() << "it was accepted";
        return std::string();
    };
    EXPECT_NE(message([](auto& r) { r.view.filter = "gaus"; }).find("gauss"), std::string::npos);
    EXPECT_NE(message([](auto& r) { r.view.filter = "gauss:sigma=-1"; }).find("0.1"), std::string::npos);
    EXPECT_NE(message([](auto& r) { r.picture = PictureEncoding::None; }).find("neither"), std::string::npos);
    EXPECT_NE(message([](auto& r) { r.stop.budget = -1s; }).find("negative"), std::string::npos);
}

TEST(PictureRequest, FilesHaveTheirRequestedFormat) {
    const auto starts_with = [](PictureEncoding encoding, std::initializer_list<int> magic) {
        session::ViewRequest request = picture_request("none");
        request.picture = encoding;
        const client::ViewResult result = render(1, request);
        ASSERT_TRUE(result.has_picture()) << result.summary.message;
        ASSERT_GT(result.frame.picture.size(), magic.size());
        std::size_t i = 0;
        for (const int byte : magic) EXPECT_EQ(int(result.frame.picture[i++]), byte);
    };
    starts_with(PictureEncoding::Png, {0x89, 'P', 'N', 'G'});
    starts_with(PictureEncoding::Jpeg, {0xff, 0xd8, 0xff});
    starts_with(PictureEncoding::Exr, {0x76, 0x2f, 0x31, 0x01});
}

// Three planes on nodes, wire and master, and the picture made of them; filters need more.
TEST(PictureRequest, OfColorAloneKeepsNoSecondMoments) {
    session::ViewRequest request = picture_request("none");
    request.film = true;
    request.view.channels = {frame::Channel::Color};
    const client::ViewResult result = render(2, request);
    ASSERT_TRUE(result.film()) << result.summary.message;
    EXPECT_EQ(result.film()->channels.plane_count(), 3u);
    ASSERT_TRUE(result.has_picture());
    const frame::Image picture = frame::resolve(*result.film(), frame::Channel::Color);
    std::vector<float> planes;
    for (std::uint32_t c = 0; c < 3; ++c) {
        for (std::size_t i = 0; i < picture.pixel_count(); ++i) planes.push_back(picture.pixel(i)[c]);
    }
    const auto bytes = std::as_bytes(std::span(planes));
    EXPECT_TRUE(std::ranges::equal(result.frame.picture, bytes));
    request.view.filter = "gauss";
    EXPECT_TRUE(render(1, request).film()->channels.contains(frame::Channel::Radiance));
}

// Neither from the start nor later.
TEST(PictureRequest, AReproducibleFrameHasNoFilterWithOtherBitsElsewhere) {
    LoopbackCluster cluster;
    cluster.add_node("null", {}, 5us);
    auto blobs = std::make_shared<scene::BlobStore>();
    const auto session = cluster.batch(blobs), other = cluster.session(blobs);
    session::ViewRequest request = picture_request("oidn");
    request.reproducible = true;
    EXPECT_THROW((void)client::render(*session, request, {}, {}), Error);
    request.view.filter = "gauss";
    request.stop.spp = 64;
    std::string refusal;
    const auto meddle = [&](const session::ViewProgress& progress) {
        if (progress.phase != session::Phase::Rendering || progress.samples == 0 || !refusal.empty()) return;
        refusal = "none";
        try {
            (void)other->set_filter("", "oidn");
        } catch (const Error& error) {
            refusal = error.what();
        }
    };
    const client::ViewResult result = client::render(*session, request, meddle, {});
    EXPECT_NE(refusal.find("filter 'oidn' does not give the same bits"), std::string::npos) << refusal;
    EXPECT_EQ(result.summary.picture.filter, "gauss");
}

// The clock decides how many samples there are; every pixel has at least the two that a variance takes.
TEST(PictureRequest, WithABudgetEveryPixelHasTwoSamples) {
    session::ViewRequest request = picture_request("gauss");
    request.picture = PictureEncoding::Png;
    request.stop = {.spp = session::MaxSamplesPerPixel, .budget = 400ms};
    const client::ViewResult result = render(2, request, 2us, 3);
    ASSERT_TRUE(result.has_picture()) << result.summary.message;
    EXPECT_EQ(result.summary.outcome, session::Outcome::TimeUp);
    EXPECT_GE(result.summary.min_samples, 2u);
    EXPECT_GT(result.summary.picture.seconds_predicted, 0.0);
}

// Once the rate is known, a budget that is too small renders a smaller picture and upsamples it.
TEST(PictureRequest, ATooSmallBudgetGivesAnUpsampledPictureWithANote) {
    session::ViewRequest request = picture_request("gauss");
    request.stop = {.spp = session::MaxSamplesPerPixel, .budget = 150ms, .adapts_size = true};
    const client::ViewResult result =
        render(1, request, 40us, 4);  // 2 samples of 5400 pixels: 0.4 s of one worker
    ASSERT_TRUE(result.has_picture()) << result.summary.message;
    EXPECT_GT(result.summary.picture.scale, 1u);
    EXPECT_EQ(result.frame.width, 90u);
    EXPECT_EQ(result.frame.height, 60u);
    EXPECT_GE(result.summary.min_samples, 1u);
    ASSERT_FALSE(result.summary.picture.notes.empty());
    EXPECT_NE(result.summary.picture.notes.back().find("upsampled"), std::string::npos);
}

// The film is kept; the new filter's features are rendered with the samples from then on.
TEST(PictureRequest, ChangingTheFilterKeepsTheSamplesAndReportsAddedChannels) {
    LoopbackCluster cluster;
    for (int i = 0; i < 2; ++i) cluster.add_node("null", {}, 5us);
    auto blobs = std::make_shared<scene::BlobStore>();
    const auto session = cluster.batch(blobs), other = cluster.session(blobs);
    session::ViewRequest request = picture_request("none");
    request.stop.spp = 64;
    request.film = true;
    std::string answer, refusal;
    const auto meddle = [&](const session::ViewProgress& progress) {
        if (progress.phase != session::Phase::Rendering || progress.samples == 0 || !answer.empty()) return;
        try {
            (void)other->set_filter("", "no such filter");
        } catch (const Error& error) {
            refusal = error.what();
        }
        answer = other->set_filter("", "bilateral");
    };
    const client::ViewResult result = client::render(*session, request, meddle, {});
    ASSERT_EQ(result.summary.outcome, session::Outcome::Complete) << result.summary.message;
    EXPECT_NE(refusal.find("no such filter"), std::string::npos);
    EXPECT_NE(answer.find("albedo"), std::string::npos) << answer;
    EXPECT_NE(answer.find("from now on"), std::string::npos) << answer;
    EXPECT_EQ(result.summary.picture.filter, "bilateral");
    session::ViewRequest plain = picture_request("none");
    plain.stop.spp = 64;
    plain.film = true;
    const client::ViewResult expected = client::render(*session, plain, {}, {});
    EXPECT_EQ(to_hex(frame::film_hash(*result.film())), to_hex(frame::film_hash(*expected.film())));
    EXPECT_NE(result.frame.picture, expected.frame.picture) << "the filter had nothing to work on";
    EXPECT_THROW((void)other->set_filter("", "gauss"), Error) << "no frame is being rendered";
}

TEST(PictureRequest, AdaptsItsSizeOnlyWithABudgetAndWithoutFilm) {
    session::ViewRequest request = picture_request("none");
    request.stop.adapts_size = true;
    EXPECT_THROW((void)render(1, request), Error);
}

}  // namespace
}  // namespace tessera::test
