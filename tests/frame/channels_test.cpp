// Channel sets can hold unknown channels, and report them.
#include "mediator/frame/channels.h"

#include <gtest/gtest.h>

#include <set>
#include <vector>

namespace tessera::frame {
namespace {

TEST(Channels, EveryRowHasADescription) {
    std::set<std::string_view> names;
    for (const ChannelInfo& entry : ChannelTable) {
        EXPECT_TRUE(names.insert(entry.name).second) << entry.name;
        EXPECT_GT(entry.components, 0u);
        EXPECT_FALSE(entry.meaning.empty());
        EXPECT_EQ(channel_by_name(entry.name), entry.channel);
        EXPECT_EQ(info(entry.channel).name, entry.name);
    }
    EXPECT_FALSE(channel_by_name("no such channel"));
}

TEST(Channels, PlanesAreInTheOrderOfTheNumbers) {
    const ChannelSet set{Channel::Color, Channel::Radiance, Channel::Depth};
    EXPECT_EQ(set.first_plane(Channel::Radiance), 0u);
    EXPECT_EQ(set.first_plane(Channel::Depth), 6u);
    EXPECT_EQ(set.first_plane(Channel::Color), 7u);
    EXPECT_EQ(set.plane_count(), 10u);
    std::vector<Channel> visited;
    EXPECT_TRUE(set.for_each([&](const ChannelInfo& entry) {
        visited.push_back(entry.channel);
        return true;
    }));
    EXPECT_EQ(visited, (std::vector{Channel::Radiance, Channel::Depth, Channel::Color}));
    EXPECT_FALSE(set.for_each([](const ChannelInfo& entry) { return entry.channel != Channel::Depth; }));
}

TEST(Channels, ASetHoldsAnyOf128) {
    for (unsigned number = 0; number < ChannelSet::Capacity; ++number) {
        const auto channel = static_cast<Channel>(number);
        ChannelSet set{Channel::Albedo};
        set.insert(channel);
        EXPECT_TRUE(set.contains(channel));
        EXPECT_EQ(set.is_known(), number < ChannelCount) << number;
        EXPECT_EQ(ChannelSet::from_words(set.words()), set);
        EXPECT_TRUE(set.contains(ChannelSet{Channel::Albedo}));
        EXPECT_EQ(ChannelSet{Channel::Albedo}.contains(set), channel == Channel::Albedo);
        EXPECT_EQ((set - ChannelSet{Channel::Albedo}).contains(channel), channel != Channel::Albedo);
        EXPECT_EQ(ChannelSet{channel} | ChannelSet{Channel::Albedo}, set);
        set.erase(channel);
        set.erase(Channel::Albedo);
        EXPECT_TRUE(set.empty());
    }
}

TEST(Channels, DerivedOnesNeedRadiance) {
    using enum Channel;
    EXPECT_EQ((ChannelSet{Radiance, BlockVariance, FirstHalf}).malformed(), nullptr);
    EXPECT_NE((ChannelSet{Color, BlockVariance}).malformed(), nullptr);
    EXPECT_NE((ChannelSet{FirstHalf}).not_renderable(), nullptr);
}

TEST(Channels, RootIsMergedAsMoments) {
    const ChannelInfo& root = info(channel_by_name("root").value());
    EXPECT_EQ(static_cast<unsigned>(root.channel), 15u);
    EXPECT_EQ(root.rule, MergeRule::Moments);
    EXPECT_EQ(root.plane_count(), 6u);
    EXPECT_EQ(ChannelSet{Channel::Root}.not_renderable(), nullptr);
}

TEST(Channels, HalfBuffersOfOldFilmsAreReadButNotRendered) {
    const ChannelSet old{Channel::Radiance, Channel::HalfBufferA};
    EXPECT_EQ(old.malformed(), nullptr);
    EXPECT_NE(std::string_view(old.not_renderable()).find("first_half"), std::string_view::npos);
    EXPECT_FALSE(ChannelSet::all().contains(Channel::HalfBufferA));
    EXPECT_EQ(ChannelSet::all().not_renderable(), nullptr);
}

}  // namespace
}  // namespace tessera::frame
