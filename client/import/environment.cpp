#include "client/import/environment.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "client/import/limits.h"
#include "client/import/local_files.h"
#include "mediator/frame/image.h"
#include "mediator/picture/exr_header.h"
#include "mediator/picture/hdr_reader.h"

namespace tessera::import {
namespace {

frame::Image read_exr(const std::filesystem::path& file) {
    const Rect window = picture::checked_exr_window(file.string(), ImageLimits);
    Imf::InputFile input(file.c_str(), 0);
    constexpr const char* Channels[] = {"R", "G", "B"};
    frame::Image image(static_cast<std::uint32_t>(window.width), static_cast<std::uint32_t>(window.height),
                       3);
    // OpenEXR addresses pixels by data window coordinates, which need not start at 0.
    constexpr std::ptrdiff_t Pixel = 3 * sizeof(float);
    const std::ptrdiff_t row = Pixel * window.width;
    char* origin = reinterpret_cast<char*>(image.values.data()) - window.x * Pixel - window.y * row;
    Imf::FrameBuffer target;
    for (std::size_t k = 0; k < 3; ++k) {
        if (!input.header().channels().findChannel(Channels[k])) {
            throw Error(ErrorCode::InvalidInput, "it has no channels R, G and B: convert it");
        }
        target.insert(Channels[k], Imf::Slice(Imf::FLOAT, origin + k * sizeof(float), Pixel,
                                              static_cast<std::size_t>(row)));
    }
    input.setFrameBuffer(target);
    input.readPixels(window.y, window.bottom() - 1);
    return image;
}

frame::Image read_hdr(const std::filesystem::path& file) {
    const auto bytes = read_whole_file(file);
    if (!bytes) throw bytes.error();
    return picture::decode_hdr(std::as_bytes(std::span(*bytes)), ImageLimits);
}

frame::Image read(const std::filesystem::path& file) {
    std::error_code ignored;
    if (!std::filesystem::exists(file, ignored)) {
        throw Error(ErrorCode::NotFound, "there is no such file: check the name");
    }
    if (!std::filesystem::is_regular_file(file, ignored)) {
        throw Error(ErrorCode::InvalidInput, "it is not a regular file: name a file");
    }
    std::string extension = file.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    if (extension == ".hdr") return read_hdr(file);
    if (extension == ".exr") return read_exr(file);
    throw Error(ErrorCode::InvalidInput, "its extension is neither .exr nor .hdr: convert it");
}

}  // namespace

ObjectId add_environment(const std::filesystem::path& file, SceneBuilder& builder) {
    const std::string named = "environment '" + file.string() + "': ";
    frame::Image image;
    try {
        image = read(file);
    } catch (const Error& error) {
        throw Error(error.code(), named + error.what());
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::exception& error) {  // of OpenEXR
        throw Error(ErrorCode::InvalidInput,
                    named + "it cannot be read (" + error.what() + "): convert it again");
    }
    std::size_t bad = 0;
    for (float& value : image.values) {
        const bool usable = std::isfinite(value) && value >= 0.0f;
        bad += usable ? 0 : 1;
        if (!usable) value = 0.0f;
    }
    if (bad > 0)
        builder.notice(named + std::to_string(bad) + " values are negative or not finite and became 0");
    scene::Texture texture;
    texture.name = file.filename().string();
    texture.width = image.width;
    texture.height = image.height;
    texture.format = scene::TexelFormat::RgbFloat;
    texture.wrap_t = scene::Wrap::Clamp;
    texture.texels = builder.blob(image.values);
    return builder.add(std::move(texture));
}

}  // namespace tessera::import
