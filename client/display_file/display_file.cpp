#include "client/display_file/display_file.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <glm/geometric.hpp>
#include <set>

#include "client/display_file/output_keys.h"
#include "client/display_file/output_reader.h"
#include "client/display_file/overlaps.h"
#include "client/display_file/screens.h"
#include "mediator/base/nearest.h"
#include "mediator/display/validate.h"

namespace tessera::display_file {

namespace {

using display::Display;

void read_settings(Section section, Display& display) {
    display.name = section.text("name").value_or(display.name);
    display.camera = section.text("camera").value_or("");
    display.units_per_metre = section.number("units_per_metre", 1e-6, 1e6).value_or(display.units_per_metre);
    display.rate = section.number("rate", 0.1, 1000.0).value_or(display.rate);
    display.spp =
        std::uint64_t(section.whole("spp", 1, std::int64_t{1} << 24).value_or(std::int64_t(display.spp)));
    display.filter = section.text("filter").value_or("");
    display.coarsest = std::uint32_t(section.whole("coarsest", 1, 8).value_or(display.coarsest));
    if (display.coarsest != 1 && display.coarsest != 2 && display.coarsest != 4 && display.coarsest != 8)
        section.refuse("coarsest",
                       "'coarsest' must be 1, 2, 4 or 8: the first picture has 1/coarsest of the size");
    display.max_bounces = std::uint32_t(section.whole("max_bounces", 0, 1024).value_or(display.max_bounces));
    display.exposure = section.number("exposure", -60.0, 60.0).value_or(display.exposure);
    display.white = section.number("white", 0.0, 1e6).value_or(display.white);
    if (display.white > 0.0) display.view_transform = view::ViewTransform::Reinhard;
    const auto transforms = enumerators(view::ViewTransform{});
    if (const auto index = section.choice("view_transform", transforms))
        display.view_transform = static_cast<view::ViewTransform>(*index);
    display.stereo_difference = section.truth("stereo_difference").value_or(false);
    section.refuse_unknown();
}

// Rotation that turns -z to `look` and keeps the head upright.
glm::dquat looking(const glm::dvec3& look) {
    const glm::dvec3 side = glm::cross(look, glm::dvec3(0.0, 1.0, 0.0));
    const glm::dvec3 right = glm::length(side) > 1e-6 ? glm::normalize(side) : glm::dvec3(1.0, 0.0, 0.0);
    return glm::normalize(glm::quat_cast(glm::dmat3(right, glm::cross(right, look), -look)));
}

void read_head(Section section, Display& display) {
    display.head.position = section.point("position").value_or(display.head.position);
    const auto look = section.direction("look");
    if (look) display.head.orientation = looking(*look);
    if (const auto turn = section.numbers("orientation", -1e3, 1e3)) {
        if (look) section.refuse("orientation", "has both 'look' and 'orientation': give one of them");
        if (turn->size() != 4) section.refuse("orientation", "'orientation' must be [w, x, y, z]");
        const glm::dquat q((*turn)[0], (*turn)[1], (*turn)[2], (*turn)[3]);
        if (!(glm::length(q) > 1e-6)) section.refuse("orientation", "'orientation' has no length");
        display.head.orientation = glm::normalize(q);
    }
    display.eye_separation = section.number("eye_separation", 0.0, 10.0).value_or(display.eye_separation);
    display.zero_parallax = section.number("zero_parallax", 0.0, 1e6).value_or(display.zero_parallax);
    section.refuse_unknown();
}

display::Layer read_layer(Section section) {
    constexpr std::array<std::string_view, 3> Renderers{"path", "whitted", "raster"};
    constexpr std::array Kinds{view::Renderer::PathTracing, view::Renderer::Whitted, view::Renderer::Raster};
    display::Layer layer;
    const auto name = section.text("name");
    if (!name) section.require("name");
    layer.name = *name;
    section.call("layer '" + layer.name + "'");
    if (const auto index = section.choice("renderer", Renderers)) layer.renderer = Kinds[*index];
    if (const auto numbers = section.numbers("layers", 0.0, 31.0)) {
        layer.layers = 0;
        for (const double number : *numbers) {
            if (number != std::uint32_t(number))
                section.refuse("layers", "'layers' must be whole numbers from 0 to 31");
            layer.layers |= 1u << std::uint32_t(number);
        }
        if (layer.layers == 0) section.refuse("layers", "'layers' is empty: it would show nothing");
    }
    layer.shown = section.truth("shown").value_or(true);
    section.refuse_unknown();
    return layer;
}

void read_layers(Section& document, Display& display) {
    std::set<std::string> names;
    for (Section& section : document.sections("layer")) {
        display.layers.push_back(read_layer(section));
        if (!names.insert(display.layers.back().name).second)
            section.refuse("name", "two layers are called '" + display.layers.back().name + "'");
    }
    if (display.layers.size() > display::MaxLayers) {
        document.refuse("layer", "a display has at most " + std::to_string(display::MaxLayers) + " layers");
    }
}

std::map<std::string, NamedScreen> read_screens(Section& document) {
    std::map<std::string, NamedScreen> screens;
    for (Section& section : document.sections("screen")) {
        const auto name = section.text("name");
        if (!name) section.require("name");
        section.call("screen '" + *name + "'");
        if (section.has("fov")) section.refuse("fov", "has 'fov': that is for an output's own screen");
        if (!has_screen(section))
            section.refuse("needs lower_left, lower_right and upper_left, or cylinder, or dome");
        const NamedScreen screen{.surface = read_screen(section, 1.0),
                                 .black = section.number("black", 0.0, 0.5).value_or(0.0)};
        if (!screens.emplace(*name, screen).second)
            section.refuse("name", "two screens have this name: rename one");
        section.refuse_unknown();
    }
    return screens;
}

void adjust(Section section, std::vector<ReadOutput>& outputs) {
    const auto name = section.text("output");
    if (!name) section.require("output");
    section.call("adjust '" + *name + "'");
    const auto found =
        std::ranges::find(outputs, *name, [](const ReadOutput& read) { return read.output.name; });
    if (found == outputs.end()) {
        std::vector<std::string> names;
        for (const ReadOutput& read : outputs) names.push_back(read.output.name);
        const auto meant = nearest(*name, names);
        section.refuse("output",
                       "there is no such output" + (meant ? "; did you mean '" + *meant + "'?" : ""));
    }
    if (section.has("turn"))
        section.refuse("turn", "'turn' applies to a whole wall: write this output as a separate [[output]]");
    found->has_own_blend = found->has_own_blend || section.has("blend");
    read_output_keys(section, found->output);
    section.refuse_unknown();
}

void check(const ReadOutput& read) {
    const display::Output& output = read.output;
    const auto refuse = [&](const std::string& key, const std::string& why) {
        read.section.refuse(key, why);
    };
    if (output.stereo == display::Stereo::InterlacedRows && !output.points.empty())
        refuse("stereo",
               "has interlaced rows and a warp or points: interlaced rows must match the panel's "
               "rows and cannot be warped; use another stereo mode");
    if (output.stereo == display::Stereo::SideBySide && output.width % 2 != 0)
        refuse("size", "shares its width between the eyes: it must be even");
    if (output.stereo == display::Stereo::TopBottom && output.height % 2 != 0)
        refuse("size", "shares its height between the eyes: it must be even");
    if (!(output.blend.left + output.blend.right <= output.width &&
          output.blend.top + output.blend.bottom <= output.height))
        refuse("blend", "its soft edges meet in the middle: make them narrower");
}

void check_names(const std::vector<ReadOutput>& outputs) {
    std::set<std::string> names;
    for (const ReadOutput& read : outputs) {
        if (!names.insert(read.output.name).second)
            read.section.refuse(
                "name", "two outputs are called '" + read.output.name + "': the names overlap; rename one");
    }
}

// What the master would reject, reported at the output in the file.
void check_all(const Section& document, const std::vector<ReadOutput>& outputs, const Display& display) {
    const std::vector<std::string> problems = display::problems(display);
    if (problems.empty()) return;
    for (const ReadOutput& read : outputs) {
        const std::string name = "output '" + read.output.name + "': ";
        if (problems.front().starts_with(name)) read.section.refuse(problems.front().substr(name.size()));
    }
    document.refuse(problems.front());
}

}  // namespace

DisplayFile parse_display(std::string_view text, const std::string& path, scene::BlobStore& blobs) {
    const Value root = parse_document(text, path);
    Section document(root, path, "");
    DisplayFile file;
    Display& display = file.display;
    display.name = std::filesystem::path(path).stem().string();
    if (const auto section = document.section("display")) read_settings(*section, display);
    if (const auto section = document.section("head")) read_head(*section, display);
    read_layers(document, display);
    ReadContext context{.folder = std::filesystem::path(path).parent_path().string(),
                        .screens = read_screens(document),
                        .head = display.head,
                        .blobs = blobs};
    std::vector<ReadOutput> outputs;
    for (const Section& section : document.sections("wall"))
        std::ranges::move(read_wall_outputs(section), std::back_inserter(outputs));
    for (const Section& section : document.sections("output"))
        outputs.push_back(read_output(section, context));
    for (const Section& section : document.sections("adjust")) adjust(section, outputs);
    document.refuse_unknown();
    if (outputs.empty()) document.refuse("has no outputs: write an [[output]] or a [[wall]]");
    if (outputs.size() > display::MaxOutputs) {
        outputs[display::MaxOutputs].section.refuse("is one too many: a display has at most " +
                                                    std::to_string(display::MaxOutputs) + " outputs");
    }
    check_names(outputs);
    blend_overlaps(outputs, context);
    for (ReadOutput& read : outputs) {
        check(read);
        display.outputs.push_back(read.output);
        file.geometry.push_back(std::move(read.geometry));
    }
    check_all(document, outputs, display);
    return file;
}

DisplayFile read_display(const std::string& path, scene::BlobStore& blobs) {
    return parse_display(read_text(path), path, blobs);
}

}  // namespace tessera::display_file
