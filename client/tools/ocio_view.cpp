#include "client/tools/ocio_view.h"

#ifdef TESSERA_OCIO
#include <OpenColorIO/OpenColorIO.h>

#include <array>
#include <memory>
#include <string_view>
#include <vector>
#endif

namespace tessera::tools {

#ifdef TESSERA_OCIO

namespace {

namespace ocio = OCIO_NAMESPACE;

constexpr const char* Rec709 = "lin_rec709";

struct Specification {
    std::string config, display, view;
};

Expected<Specification> parse(const std::string& text) {
    std::array<std::string, 3> parts;
    std::size_t begin = 0;
    for (std::size_t i = 0; i < parts.size(); ++i) {
        const std::size_t end = i + 1 < parts.size() ? text.find(':', begin) : std::string::npos;
        parts[i] = text.substr(begin, end == std::string::npos ? end : end - begin);
        if (end == std::string::npos) break;
        begin = end + 1;
    }
    if (parts[0].empty())
        return failure(ErrorCode::InvalidInput, "--ocio: name a configuration: CONFIG[:DISPLAY[:VIEW]]");
    return Specification{parts[0], parts[1], parts[2]};
}

std::string listed(int count, const std::function<const char*(int)>& name) {
    std::string text;
    for (int i = 0; i < count; ++i) text += (text.empty() ? "" : ", ") + std::string(name(i));
    return text;
}

// A configuration that knows linear Rec. 709 and its relation to ACES2065-1, the interchange space of others (SMPTE ST 2065-1,
// D65 adapted to the ACES white by Bradford's method).
ocio::ConstConfigRcPtr rec709_config() {
    constexpr std::array<double, 16> ToAces{0.4395756842, 0.3839125893, 0.1765117266, 0.0,  //
                                            0.0896003829, 0.8147141542, 0.0956854629, 0.0,  //
                                            0.0174154827, 0.1087343522, 0.8738501651, 0.0,  //
                                            0.0,          0.0,          0.0,          1.0};
    const ocio::ConfigRcPtr config = ocio::Config::CreateRaw()->createEditableCopy();
    const ocio::ColorSpaceRcPtr aces = ocio::ColorSpace::Create();
    aces->setName("ACES2065-1");
    config->addColorSpace(aces);
    const ocio::ColorSpaceRcPtr rec709 = ocio::ColorSpace::Create();
    rec709->setName(Rec709);
    const ocio::MatrixTransformRcPtr matrix = ocio::MatrixTransform::Create();
    matrix->setMatrix(ToAces.data());
    rec709->setTransform(matrix, ocio::COLORSPACE_DIR_TO_REFERENCE);
    config->addColorSpace(rec709);
    config->setRole(ocio::ROLE_INTERCHANGE_SCENE, "ACES2065-1");
    return config;
}

// The configuration's colour space of linear Rec. 709 primaries, as common configurations call it.
std::string rec709_space(const ocio::ConstConfigRcPtr& config) {
    for (const char* name :
         {"Linear Rec.709 (sRGB)", "lin_rec709", "Utility - Linear - sRGB", "Utility - Linear - Rec.709",
          "Linear Rec.709", "Linear sRGB", "lin_srgb", "linear_rec709"}) {
        if (config->getColorSpace(name) != nullptr) return name;
    }
    return {};
}

// From linear Rec. 709 to the encoded values of a display.
ocio::ConstProcessorRcPtr processor_of(const ocio::ConstConfigRcPtr& config, const char* display,
                                       const char* view) {
    const ocio::DisplayViewTransformRcPtr show = ocio::DisplayViewTransform::Create();
    show->setDisplay(display);
    show->setView(view);
    if (const std::string space = rec709_space(config); !space.empty()) {
        show->setSrc(space.c_str());
        return config->getProcessor(show);
    }
    if (!config->hasRole(ocio::ROLE_INTERCHANGE_SCENE)) return nullptr;
    const ocio::GroupTransformRcPtr group = ocio::GroupTransform::Create();
    const ocio::ConstConfigRcPtr ours = rec709_config();
    group->appendTransform(ours->getProcessor(Rec709, "ACES2065-1")->createGroupTransform());
    show->setSrc(ocio::ROLE_INTERCHANGE_SCENE);
    group->appendTransform(show);
    return config->getProcessor(group);
}

Expected<picture::CustomView> view_of(const Specification& wanted) {
    const auto wrong = [&](const std::string& text) {
        return failure(ErrorCode::InvalidInput, "--ocio: " + wanted.config + ": " + text);
    };
    const ocio::ConstConfigRcPtr config = ocio::Config::CreateFromFile(wanted.config.c_str());
    config->validate();
    const std::string display = wanted.display.empty() ? config->getDefaultDisplay() : wanted.display;
    const int views = config->getNumViews(display.c_str());
    if (views == 0) {
        return wrong("there is no display '" + display + "'; it has " +
                     listed(config->getNumDisplays(), [&](int i) { return config->getDisplay(i); }));
    }
    const std::string view = wanted.view.empty() ? config->getDefaultView(display.c_str()) : wanted.view;
    bool exists = false;
    for (int i = 0; i < views; ++i) exists = exists || view == config->getView(display.c_str(), i);
    if (!exists) {
        return wrong("display '" + display + "' has no view '" + view + "'; it has " +
                     listed(views, [&](int i) { return config->getView(display.c_str(), i); }));
    }
    const ocio::ConstProcessorRcPtr processor = processor_of(config, display.c_str(), view.c_str());
    if (processor == nullptr) {
        return wrong(
            "it has neither the role aces_interchange nor a colour space named 'Linear Rec.709 (sRGB)' or "
            "'lin_rec709': "
            "add one");
    }
    const ocio::ConstCPUProcessorRcPtr cpu = processor->getDefaultCPUProcessor();
    return picture::CustomView{"OpenColorIO " + display + ", " + view, [cpu](std::span<float> rgb) {
                                   ocio::PackedImageDesc pixels(rgb.data(), static_cast<long>(rgb.size() / 3),
                                                                1, 3);
                                   cpu->apply(pixels);
                               }};
}

}  // namespace

Expected<picture::CustomView> load_ocio_view(const std::string& specification) {
    const auto wanted = parse(specification);
    if (!wanted) return tl::unexpected(wanted.error());
    try {
        return view_of(*wanted);
    } catch (const ocio::Exception& error) {
        return failure(ErrorCode::InvalidInput, "--ocio: " + wanted->config + ": " + error.what());
    }
}

#else

Expected<picture::CustomView> load_ocio_view(const std::string&) {
    return failure(ErrorCode::InvalidInput,
                   "--ocio: this build has no OpenColorIO: install libopencolorio-dev and build again");
}

#endif

}  // namespace tessera::tools
