#include "mediator/picture/png_writer.h"

#include <png.h>

#include <algorithm>
#include <cmath>

#include "mediator/base/error.h"
#include "mediator/picture/atomic_file.h"

namespace tessera::picture {

namespace {

png_image describe(std::uint32_t width, std::uint32_t height, png_uint_32 format) {
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    image.width = width;
    image.height = height;
    image.format = format;
    return image;
}

std::vector<std::byte> encode(png_image image, std::span<const std::byte> pixels) {
    png_alloc_size_t size = 0;
    const bool is_measured = png_image_write_get_memory_size(image, size, 0, pixels.data(), 0, nullptr) != 0;
    std::vector<std::byte> bytes(size);
    if (!is_measured ||
        png_image_write_to_memory(&image, bytes.data(), &size, 0, pixels.data(), 0, nullptr) == 0) {
        throw Error(ErrorCode::Io, std::string("cannot encode a PNG: ") + image.message);
    }
    bytes.resize(size);
    return bytes;
}

}  // namespace

void write_png(const std::string& path, std::uint32_t width, std::uint32_t height,
               std::span<const std::uint8_t> rgb) {
    write_atomically(path, [&](const std::string& temporary) {
        png_image image = describe(width, height, PNG_FORMAT_RGB);
        if (png_image_write_to_file(&image, temporary.c_str(), 0, rgb.data(), 0, nullptr) == 0) {
            throw Error(ErrorCode::Io, "cannot write '" + path + "': " + image.message);
        }
    });
}

std::vector<std::byte> encode_png(std::uint32_t width, std::uint32_t height,
                                  std::span<const std::uint8_t> rgb) {
    return encode(describe(width, height, PNG_FORMAT_RGB), std::as_bytes(rgb));
}

std::vector<std::byte> encode_rgba_png(std::uint32_t width, std::uint32_t height,
                                       std::span<const std::uint8_t> rgba) {
    return encode(describe(width, height, PNG_FORMAT_RGBA), std::as_bytes(rgba));
}

std::vector<std::byte> encode_png16(std::uint32_t width, std::uint32_t height, std::span<const float> rgb) {
    std::vector<std::uint16_t> values;
    values.reserve(rgb.size());
    for (const float value : rgb)
        values.push_back(static_cast<std::uint16_t>(std::lround(std::clamp(value, 0.0f, 1.0f) * 65535.0f)));
    return encode(describe(width, height, PNG_FORMAT_LINEAR_RGB), std::as_bytes(std::span(values)));
}

}  // namespace tessera::picture
