#include "client/import/environment.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "client/import/image_decoder.h"
#include "client/import/limits.h"
#include "client/import/local_files.h"
#include "mediator/frame/image.h"

namespace tessera::import {
namespace {

frame::Image read_exr(const std::filesystem::path& file) {
    Imf::InputFile input(file.c_str(), 0);
    const Imath::Box2i window = input.header().dataWindow();
    const std::int64_t width = std::int64_t{window.max.x} - window.min.x + 1;
    const std::int64_t height = std::int64_t{window.max.y} - window.min.y + 1;
    if (width < 1 || height < 1 || width > MaxImageEdge || height > MaxImageEdge ||
        static_cast<std::uint64_t>(width * height) > MaxImagePixels) {
        throw Error(ErrorCode::InvalidInput, "it claims " + std::to_string(width) + " x " +
                                                 std::to_string(height) + " pixels: scale it down");
    }
    constexpr const char* Channels[] = {"R", "G", "B"};
    frame::Image image(static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height), 3);
    // OpenEXR addresses pixels by data window coordinates, which need not start at 0.
    constexpr std::ptrdiff_t Pixel = 3 * sizeof(float);
    char* origin =
        reinterpret_cast<char*>(image.values.data()) - (window.min.x + window.min.y * width) * Pixel;
    Imf::FrameBuffer target;
    for (std::size_t k = 0; k < 3; ++k) {
        if (!input.header().channels().findChannel(Channels[k])) {
            throw Error(ErrorCode::InvalidInput, "it has no channels R, G and B: convert it");
        }
        target.insert(Channels[k], Imf::Slice(Imf::FLOAT, origin + k * sizeof(float), Pixel,
                                              static_cast<std::size_t>(Pixel * width)));
    }
    input.setFrameBuffer(target);
    input.readPixels(window.min.y, window.max.y);
    return image;
}

frame::Image read_hdr(const std::filesystem::path& file) {
    const auto bytes = read_whole_file(file);
    if (!bytes) throw bytes.error();
    auto image = decode_hdr(*bytes);
    if (!image) throw image.error();
    return std::move(*image);
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
