#include "master/render/filter_change.h"

#include <gtest/gtest.h>

#include "master/render/view_request.h"

namespace tessera::master {
namespace {

using Effect = FilterChange::Effect;

view::View rendered_with(const std::string& filter, frame::ChannelSet asked = {frame::Channel::Radiance}) {
    view::View view;
    view.channels = asked;
    view.filter = filter;
    complete(view);
    return view;
}

TEST(FilterChange, ParametersKeepTheFilm) {
    const FilterChange change = filter_change(rendered_with("gauss"), "gauss:sigma=3");
    EXPECT_EQ(change.effect, Effect::Kept);
    EXPECT_EQ(change.view.filter, "gauss:sigma=3");
}

TEST(FilterChange, ExistingChannelsKeepTheFilm) {
    const view::View view = rendered_with("bilateral");
    const FilterChange change = filter_change(view, "none");
    EXPECT_EQ(change.effect, Effect::Kept);
    EXPECT_EQ(change.view.channels, view.channels) << "the film keeps what it has";
}

TEST(FilterChange, MissingChannelsAreAdded) {
    const FilterChange change = filter_change(rendered_with("none"), "bilateral");
    EXPECT_EQ(change.effect, Effect::Widened);
    EXPECT_TRUE(change.view.channels.contains(frame::Channel::Albedo));
    EXPECT_NE(change.text.find("albedo"), std::string::npos) << change.text;
    EXPECT_NE(change.text.find("from now on"), std::string::npos) << change.text;
}

TEST(FilterChange, OtherPathClassesRestart) {
    const FilterChange moments = filter_change(rendered_with("none", {frame::Channel::Color}), "gauss");
    EXPECT_EQ(moments.effect, Effect::Restarted);
    EXPECT_NE(moments.text.find("variance"), std::string::npos) << moments.text;
    const FilterChange paths = filter_change(rendered_with("gauss"), "psvgf");
    EXPECT_EQ(paths.effect, Effect::Restarted);
    EXPECT_NE(paths.text.find("path classes"), std::string::npos) << paths.text;
}

}  // namespace
}  // namespace tessera::master
