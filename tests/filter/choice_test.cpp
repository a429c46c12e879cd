// Parsing of --filter.
#include "mediator/filter/choice.h"

#include <gtest/gtest.h>

#include "master/filter/catalog.h"
#include "tests/filter/synthetic.h"

namespace tessera::filter {
namespace {

TEST(FilterChoice, NamesAndValues) {
    const auto choice = parse_choice("gauss:sigma=3.5", catalog());
    ASSERT_TRUE(choice);
    EXPECT_EQ(choice->entry->description.name, "gauss");
    EXPECT_EQ(choice->values, Values{3.5});
    EXPECT_EQ(to_text(*choice), "gauss:sigma=3.5");
    EXPECT_EQ(to_text(*parse_choice("gauss:sigma=2", catalog())), "gauss");
    EXPECT_EQ(parse_choice("", catalog())->entry->description.name, "none");
}

TEST(FilterChoice, RejectsWithReasonAndRemedy) {
    const auto message = [](std::string_view text) {
        const auto choice = parse_choice(text, catalog());
        return choice ? std::string("accepted") : std::string(choice.error().what());
    };
    EXPECT_NE(message("gaus").find("gauss"), std::string::npos);
    EXPECT_NE(message("gauss:radius=3").find("it has sigma"), std::string::npos);
    EXPECT_NE(message("gauss:sigma").find("sigma=VALUE"), std::string::npos);
    EXPECT_NE(message("gauss:sigma=1e9").find("from 0.1 to 64"), std::string::npos);
    for (const char* text : {"gauss:sigma=nan", "gauss:sigma=inf", "gauss:sigma=", "gauss:sigma=2x",
                             "gauss:=", "gauss:,", ":", "none:x=1", "gauss:sigma=2:sigma=3"}) {
        EXPECT_NE(message(text), "accepted") << text;
    }
}

TEST(FilterChoice, ColorIsEnoughWithoutAFilter) {
    using enum frame::Channel;
    const auto lacks = [](std::string_view filter, frame::ChannelSet there) {
        return missing_channels(*parse_choice(filter, catalog()), there);
    };
    EXPECT_EQ(lacks("", {Color}), frame::ChannelSet{});
    EXPECT_EQ(lacks("none", {Color, Depth}), frame::ChannelSet{});
    EXPECT_EQ(lacks("none", {Depth}), frame::ChannelSet{Radiance});
    EXPECT_EQ(lacks("gauss", {Color}), frame::ChannelSet{Radiance});
    EXPECT_EQ(lacks("gauss", {Radiance}), frame::ChannelSet{});
}

// Errors of stratified means are wanted, but films without them can be filtered.
TEST(FilterChoice, FiltersThatReadVariancesWantTheirBlocks) {
    using enum frame::Channel;
    const frame::ChannelSet most = frame::ChannelSet::all() - frame::ChannelSet{BlockVariance};
    for (const char* name : {"fdf", "nfor", "nlm", "oidn", "pixel", "psvgf", "statmc"}) {
        const Choice choice = *parse_choice(name, catalog());
        EXPECT_TRUE(missing_channels(choice, most).empty()) << name;
        EXPECT_EQ(wanted_channels(choice, most), frame::ChannelSet{BlockVariance}) << name;
        EXPECT_TRUE(wanted_channels(choice, frame::ChannelSet::all()).empty()) << name;
    }
    for (const char* name : {"none", "gauss", "bilateral", "guided"})
        EXPECT_TRUE(wanted_channels(*parse_choice(name, catalog()), most).empty()) << name;
}

TEST(FilterChoice, EveryDescriptionIsUsable) {
    for (const FilterEntry& entry : catalog()) {
        const Description& filter = entry.description;
        EXPECT_FALSE(filter.summary.empty()) << filter.name;
        for (const Parameter& parameter : filter.parameters) {
            EXPECT_FALSE(parameter.meaning.empty()) << filter.name << " " << parameter.name;
            if (parameter.choices.empty()) {
                EXPECT_LE(parameter.minimum, parameter.default_value) << filter.name << " " << parameter.name;
                EXPECT_LE(parameter.default_value, parameter.maximum) << filter.name << " " << parameter.name;
            } else {
                EXPECT_LT(parameter.default_value, double(parameter.choices.size())) << filter.name;
            }
        }
        EXPECT_TRUE(filter.channels(default_values(filter)).contains(frame::Channel::Radiance))
            << filter.name;
    }
}

TEST(Gauss, HasTheVarianceOfItsWeights) {
    const Inputs inputs =
        synthetic_inputs(64, 64, 4, [](auto x, auto y, auto i) { return shadowed_texture(64, 64, x, y, i); });
    Inputs impulse = inputs;
    for (auto& plane : impulse.means) std::ranges::fill(plane.values(), 0.0f);
    impulse.means[0].row(0, 32)[32] = 1.0f;
    const Output out = run_filter("gauss:sigma=3", impulse);
    double sum = 0.0, second = 0.0;
    for (std::uint32_t y = 0; y < 64; ++y) {
        for (std::uint32_t x = 0; x < 64; ++x) {
            const double v = out.picture.row(0, y)[x];
            sum += v;
            second += v * (double(x) - 32) * (double(x) - 32);
        }
    }
    EXPECT_NEAR(sum, 1.0, 1e-5);
    EXPECT_NEAR(second, 9.0, 0.3);  // cut at 3 sigma
}

}  // namespace
}  // namespace tessera::filter
