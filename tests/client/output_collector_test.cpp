#include "client/output_collector.h"

#include <gtest/gtest.h>

namespace tessera::client {
namespace {

wire::OutputPicture piece(std::uint64_t frame, view::Eye eye, std::uint64_t offset, std::size_t size,
                          std::uint64_t total) {
    wire::OutputPicture picture{.frame = frame, .eye = eye, .eyes = eye == view::Eye::Mono ? 1u : 2u};
    picture.width = 2;
    picture.height = 1;
    picture.offset = offset;
    picture.total = total;
    picture.data.assign(size, std::byte(frame));
    return picture;
}

struct Collecting : testing::Test {
    OutputCollector collector;
    std::optional<OutputFrame> add(const wire::OutputPicture& picture) {
        auto frame = collector.add(wire::OutputPicture(picture));
        EXPECT_TRUE(frame) << frame.error().what();
        return frame ? std::move(*frame) : std::nullopt;
    }
};

TEST_F(Collecting, AssemblesAStereoFrame) {
    EXPECT_FALSE(add(piece(1, view::Eye::Left, 0, 4, 6)));
    EXPECT_FALSE(add(piece(1, view::Eye::Left, 4, 2, 6)));
    const auto frame = add(piece(1, view::Eye::Right, 0, 6, 6));
    ASSERT_TRUE(frame);
    ASSERT_EQ(frame->pictures.size(), 2u);
    EXPECT_EQ(frame->pictures[0].eye, view::Eye::Left);
    EXPECT_EQ(frame->pictures[0].bytes.size(), 6u);
}

TEST_F(Collecting, ResentFrameStartsOver) {
    EXPECT_FALSE(add(piece(7, view::Eye::Left, 0, 4, 6)));  // its rest is lost
    EXPECT_FALSE(add(piece(7, view::Eye::Left, 0, 6, 6)));  // also what came then
    EXPECT_FALSE(add(piece(7, view::Eye::Left, 0, 6, 6)));
    const auto frame = add(piece(7, view::Eye::Right, 0, 6, 6));
    ASSERT_TRUE(frame);
    ASSERT_EQ(frame->pictures.size(), 2u);
    EXPECT_EQ(frame->pictures[0].bytes.size(), 6u);
    EXPECT_EQ(frame->pictures[1].eye, view::Eye::Right);
}

TEST_F(Collecting, FrameWithoutItsBeginningIsDropped) {
    EXPECT_FALSE(add(piece(3, view::Eye::Right, 0, 6, 6)));
    EXPECT_FALSE(add(piece(3, view::Eye::Left, 4, 2, 6)));
    EXPECT_FALSE(add(piece(3, view::Eye::Left, 0, 6, 6)));
    const auto frame = add(piece(3, view::Eye::Right, 0, 6, 6));
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->pictures[0].eye, view::Eye::Left);
}

TEST_F(Collecting, NewerFrameDropsAnIncompleteOne) {
    EXPECT_FALSE(add(piece(1, view::Eye::Mono, 0, 4, 6)));
    const auto frame = add(piece(2, view::Eye::Mono, 0, 6, 6));
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->number, 2u);
}

TEST_F(Collecting, ContradictingPartsAreRejected) {
    EXPECT_FALSE(add(piece(1, view::Eye::Mono, 0, 4, 6)));
    EXPECT_FALSE(collector.add(piece(1, view::Eye::Mono, 5, 1, 6)));
    EXPECT_FALSE(add(piece(2, view::Eye::Mono, 0, 4, 6)));
    EXPECT_FALSE(collector.add(piece(2, view::Eye::Mono, 4, 3, 6))) << "more than it said";
}

}  // namespace
}  // namespace tessera::client
