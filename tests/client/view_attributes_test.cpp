// View attributes of an EXR: exact round trip, and errors for damaged ones.
#include "client/tools/view_attributes.h"

#include <gtest/gtest.h>

#include <glm/gtc/matrix_transform.hpp>

namespace tessera::tools {
namespace {

view::View moving_view() {
    view::View view;
    view.path_class = view::PathClass::Caustics;
    const glm::dmat4 start = glm::translate(glm::dmat4(1.0), {1.0 / 3.0, -2e6, 1e-9});
    view.camera = view::pose({.projection = scene::Projection::Orthographic,
                              .orthographic_height = 0.7,
                              .lens_radius = 0.01,
                              .focus_distance = 3.3,
                              .aperture = scene::Aperture::Gaussian},
                             start, 1.7);
    for (int step = 1; step <= 3; ++step)
        view.camera.motion.push_back(glm::rotate(start, 0.1 * step, {0.3, 1.0, 0.2}));
    return view;
}

TEST(ViewAttributes, RoundTripACameraWithLensAndMotion) {
    const view::View written = moving_view();
    const auto read = view_from_attributes(view_attributes(written));
    ASSERT_TRUE(read) << read.error().what();
    EXPECT_EQ(read->camera, written.camera);
    EXPECT_EQ(read->path_class, written.path_class);
}

// A static pinhole camera writes no motion or lens attributes.
TEST(ViewAttributes, OmitDefaults) {
    const auto attributes = view_attributes({});
    EXPECT_EQ(attributes.size(), 2u);
    const auto read = view_from_attributes(attributes);
    ASSERT_TRUE(read);
    EXPECT_TRUE(read->camera.motion.empty());
    EXPECT_TRUE(read->camera.is_pinhole());
}

TEST(ViewAttributes, LabelClampedPicturesAsBiased) {
    view::View view;
    EXPECT_FALSE(view_attributes(view).contains("tessera.biased"));
    view.clamp_indirect = 2.5f;
    EXPECT_EQ(view_attributes(view).at("tessera.biased"), "--clamp 2.5");
}

TEST(ViewAttributes, ErrorsNameTheDamagedAttribute) {
    const auto good = view_attributes(moving_view());
    for (const char* name : {"tessera.camera.pose", "tessera.camera.optics", "tessera.camera.motion"}) {
        const std::string whole = good.at(name);
        for (const std::string& text :
             {whole.substr(0, whole.rfind(' ')), std::string("nan ") + whole, std::string("x")}) {
            auto attributes = good;
            attributes[name] = text;
            const auto read = view_from_attributes(attributes);
            ASSERT_FALSE(read) << name << ": " << text;
            EXPECT_NE(std::string(read.error().what()).find(name), std::string::npos) << read.error().what();
        }
    }
    auto endless = good;
    for (int i = 0; i < 8; ++i) endless["tessera.camera.motion"] += " " + endless["tessera.camera.motion"];
    EXPECT_FALSE(view_from_attributes(endless)) << "768 steps";
}

}  // namespace
}  // namespace tessera::tools
