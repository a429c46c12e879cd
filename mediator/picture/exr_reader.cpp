#include "mediator/picture/exr_reader.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>

#include <algorithm>
#include <exception>
#include <filesystem>
#include <new>
#include <set>

#include "mediator/base/error.h"
#include "mediator/picture/exr_header.h"

namespace tessera::picture {

namespace {

Error unreadable(const std::string& reason) {
    return Error(ErrorCode::InvalidInput, reason);
}

struct ChannelName {
    std::string layer, component;
};
ChannelName split(const std::string& channel) {
    const std::size_t dot = channel.rfind('.');
    if (dot == std::string::npos) return {"", channel};
    return {channel.substr(0, dot), channel.substr(dot + 1)};
}

std::string layers_in(const Imf::ChannelList& channels) {
    std::set<std::string> names;
    for (auto channel = channels.begin(); channel != channels.end(); ++channel) {
        const std::string layer = split(channel.name()).layer;
        names.insert(layer.empty() ? "R G B" : layer);
    }
    std::string text;
    for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
    return text;
}

// Full names, in the order of the components.
std::vector<std::string> channels_of(const Imf::ChannelList& channels, const std::string& layer) {
    std::vector<std::string> components;
    for (auto channel = channels.begin(); channel != channels.end(); ++channel) {
        const ChannelName name = split(channel.name());
        if (name.layer == layer) components.push_back(name.component);
    }
    if (components.empty()) {
        throw unreadable(
            (layer.empty() ? "it has no channels without a layer" : "it has no layer '" + layer + "'") +
            ": it has " + layers_in(channels));
    }
    const std::vector<std::string> triples[] = {{"R", "G", "B"}, {"X", "Y", "Z"}};
    for (const std::vector<std::string>& triple : triples) {
        const bool all = std::all_of(triple.begin(), triple.end(), [&](const std::string& component) {
            return std::find(components.begin(), components.end(), component) != components.end();
        });
        if (!all) continue;
        components = triple;
        break;
    }
    if (components.size() > 4)
        throw unreadable("layer '" + layer + "' has more than four components: split it");
    for (std::string& component : components) component.insert(0, layer.empty() ? "" : layer + ".");
    return components;
}

Picture read(const std::string& path, const std::string& layer) {
    Picture picture;
    picture.window = checked_exr_window(path);
    Imf::InputFile input(path.c_str(), 0);
    const Rect& window = picture.window;
    const std::vector<std::string> names = channels_of(input.header().channels(), layer);
    picture.image =
        frame::Image(static_cast<std::uint32_t>(window.width), static_cast<std::uint32_t>(window.height),
                     static_cast<std::uint32_t>(names.size()));
    // EXR needs the address of pixel (0, 0), which may be outside the window.
    const auto x_stride = static_cast<std::ptrdiff_t>(names.size() * sizeof(float));
    const std::ptrdiff_t y_stride = x_stride * window.width;
    char* origin =
        reinterpret_cast<char*>(picture.image.values.data()) - window.x * x_stride - window.y * y_stride;
    Imf::FrameBuffer target;
    for (std::size_t c = 0; c < names.size(); ++c) {
        target.insert(names[c],
                      Imf::Slice(Imf::FLOAT, origin + c * sizeof(float), static_cast<std::size_t>(x_stride),
                                 static_cast<std::size_t>(y_stride)));
    }
    input.setFrameBuffer(target);
    input.readPixels(window.y, window.bottom() - 1);
    return picture;
}

}  // namespace

Picture read_exr(const std::string& path, const std::string& layer) {
    const std::string named = "picture '" + path + "': ";
    std::error_code ignored;
    if (!std::filesystem::exists(path, ignored))
        throw Error(ErrorCode::NotFound, named + "there is no such file: check the name");
    if (!std::filesystem::is_regular_file(path, ignored))
        throw Error(ErrorCode::InvalidInput, named + "it is not a regular file: name a file");
    try {
        return read(path, layer);
    } catch (const Error& error) {
        throw Error(error.code(), named + error.what());
    } catch (const std::bad_alloc&) {
        throw Error(ErrorCode::OutOfMemory, named + "it does not fit into memory: scale it down");
    } catch (const std::exception& error) {  // from OpenEXR
        throw Error(ErrorCode::InvalidInput,
                    named + "it cannot be read (" + error.what() + "): write it again");
    }
}

}  // namespace tessera::picture
