// Displays: a denoiser's history in each eye of an output.
#include <cmath>
#include <cstdlib>

#include "mediator/scene/fields.h"
#include "tests/cluster/display_fixture.h"
#include "tests/cluster/lit_room.h"

namespace tessera::test {
namespace {

using namespace scene;

// Mean difference of two pictures' bytes.
double difference(const std::vector<std::byte>& a, const std::vector<std::byte>& b) {
    EXPECT_EQ(a.size(), b.size());
    double sum = 0.0;
    for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i)
        sum += std::abs(std::to_integer<int>(a[i]) - std::to_integer<int>(b[i]));
    return sum / double(a.size());
}

struct DisplayHistory : Displays {
    void SetUp() override {
        Displays::SetUp();
        const LitRoom room{*ann, *blobs};
        submit(room.entries());
        submit({Update{RootId, Fields<Root>(&Root::children).bits(),
                       Root{.children = {place_id(), room.place()}}}});
        cluster.add_node("embree");
        wall.outputs = {part_of_wall("left", -1, 1)};
        wall.outputs[0].stereo = display::Stereo::SideBySide;
        wall.eye_separation = 0.6;  // so that the eyes see different walls
    }
    // Both eyes as they are shown in full size with all samples, once there are more frames than `before`.
    std::vector<client::OutputFrame::Picture> shown(std::size_t before) {
        const OutputClient& left = output_clients.at("left");
        until([&] {
            return left.frames.size() > before && all_show(wall.spp) &&
                   left.frames.back().pictures[0].width == wall.outputs[0].view_width;
        });
        return left.frames.back().pictures;
    }
    std::vector<client::OutputFrame::Picture> moved_to(double x) {
        const OutputClient& left = output_clients.at("left");
        const Version version = left.frames.back().version;
        move_camera(x);
        until([&] { return left.frames.back().version > version; });
        return shown(0);
    }
    // A display that is opened has no history.
    std::vector<client::OutputFrame::Picture> opened(const std::string& filter, std::uint64_t spp) {
        wall.filter = filter;
        wall.spp = spp;
        const std::size_t before = output_clients["left"].frames.size();
        ann->open_display(wall);
        return shown(before);
    }
};

TEST_F(DisplayHistory, EachEyeContinuesItsOwnPictures) {
    wall.filter = "psvgf";
    wall.spp = 1;
    ann->open_display(wall);
    show("left");
    auto walked = shown(0);
    for (int step = 1; step <= 12; ++step) walked = moved_to(0.004 * step);
    const auto exact = opened("none", 128), forgetful = opened("psvgf", 1);
    ASSERT_EQ(walked.size(), 2u);
    EXPECT_GT(difference(exact[0].bytes, exact[1].bytes), 5.0);
    for (const std::size_t eye : {0u, 1u}) {
        const double with = difference(walked[eye].bytes, exact[eye].bytes);
        const double without = difference(forgetful[eye].bytes, exact[eye].bytes);
        EXPECT_LT(with, 0.85 * without) << "eye " << eye;
    }
}

}  // namespace
}  // namespace tessera::test
