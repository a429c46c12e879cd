#include "client/import/image_decoder.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <string>

#include "client/import/jpeg_check.h"
#include "client/import/limits.h"
#include "mediator/picture/color.h"
#include "mediator/picture/hdr_reader.h"
#include "mediator/picture/png_reader.h"

#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#define STBI_NO_STDIO
#define STBI_ONLY_JPEG
#define STBI_ONLY_BMP
#define STBI_ONLY_TGA
#define STBI_NO_LINEAR
#define STBI_MAX_DIMENSIONS 16384
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wsign-compare"
#pragma GCC diagnostic ignored "-Wshadow"
// In damaged JPEG data, stb_image 2.27 shifts by 32 bits: it reads wrong bits then, but from its own memory.
#ifdef __clang__
#pragma clang attribute push(__attribute__((no_sanitize("shift"))), apply_to = function)
#endif
#include <stb/stb_image.h>
#ifdef __clang__
#pragma clang attribute pop
#endif
#pragma GCC diagnostic pop

namespace tessera::import {
namespace {

// Upper bound of pixels per byte of the file: a BMP has a bit per pixel, a TGA runs of 128 pixels in two bytes.
constexpr std::uint64_t PixelsPerByte = 64;

// As stb_image decides it, which skips fill bytes.
bool is_jpeg(std::span<const unsigned char> bytes) {
    const auto code =
        std::find_if(bytes.begin(), bytes.end(), [](unsigned char byte) { return byte != 0xff; });
    return code != bytes.begin() && code != bytes.end() && *code == 0xd8;
}

struct Size {
    int width = 0, height = 0;
    std::uint64_t pixels() const {
        return static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height);
    }
};

Expected<Size> checked_size(std::span<const unsigned char> bytes) {
    if (bytes.empty() || bytes.size() > static_cast<std::size_t>(std::numeric_limits<int>::max())) {
        return failure(ErrorCode::InvalidInput, "the image has no bytes or more than 2 GiB");
    }
    if (is_jpeg(bytes)) {  // before stb_image reads its tables
        if (const auto checked = check_jpeg(bytes); !checked) return tl::unexpected<Error>(checked.error());
    }
    Size size;
    int components = 0;
    if (!stbi_info_from_memory(bytes.data(), static_cast<int>(bytes.size()), &size.width, &size.height,
                               &components) ||
        size.width <= 0 || size.height <= 0) {
        return failure(ErrorCode::InvalidInput,
                       "the image is damaged or neither PNG, JPEG, BMP, TGA nor Radiance");
    }
    const std::string claim =
        "the image claims " + std::to_string(size.width) + " x " + std::to_string(size.height) + " pixels, ";
    if (static_cast<std::uint32_t>(size.width) > MaxImageEdge ||
        static_cast<std::uint32_t>(size.height) > MaxImageEdge || size.pixels() > MaxImagePixels) {
        return failure(ErrorCode::InvalidInput, claim + "more than the " + std::to_string(MaxImageEdge) +
                                                    " by " + std::to_string(MaxImagePixels / MaxImageEdge) +
                                                    " that are read");
    }
    if (!is_jpeg(bytes) && size.pixels() / PixelsPerByte > bytes.size()) {
        return failure(ErrorCode::InvalidInput,
                       claim + "but has only " + std::to_string(bytes.size()) + " bytes: save it again");
    }
    return size;
}

tl::unexpected<Error> damaged() {
    const char* reason = stbi_failure_reason();  // null for some of its failures
    return failure(ErrorCode::InvalidInput,
                   "the image is damaged" + (reason != nullptr ? " (" + std::string(reason) + ")" : ""));
}

// Not by stb_image 2.27, which never returns from a truncated run.
Expected<DecodedImage> radiance_image(std::span<const std::byte> bytes) try {
    const frame::Image linear = picture::decode_hdr(bytes, ImageLimits);
    DecodedImage image{linear.width, linear.height, {}};
    image.rgba.reserve(linear.pixel_count() * 4);
    for (std::size_t i = 0; i < linear.pixel_count(); ++i) {
        for (const float value : linear.pixel(i)) {
            const double level = picture::srgb_from_linear(std::min(double{value}, 1.0));
            image.rgba.push_back(static_cast<std::uint8_t>(std::lround(level * 255.0)));
        }
        image.rgba.push_back(255);
    }
    return image;
} catch (const Error& error) {
    return tl::unexpected<Error>(error);
}

}  // namespace

Expected<DecodedImage> decode_image(std::span<const unsigned char> bytes) {
    if (picture::is_hdr(std::as_bytes(bytes))) return radiance_image(std::as_bytes(bytes));
    // Not by stb_image, which decompresses all that the bytes expand to, whatever the header says.
    if (picture::is_png(std::as_bytes(bytes)))
        return picture::read_png_rgba(std::as_bytes(bytes), ImageLimits);
    const Expected<Size> size = checked_size(bytes);
    if (!size) return tl::unexpected<Error>(size.error());
    int width = 0, height = 0, components = 0;
    const std::unique_ptr<stbi_uc, decltype(&stbi_image_free)> decoded(
        stbi_load_from_memory(bytes.data(), static_cast<int>(bytes.size()), &width, &height, &components, 4),
        &stbi_image_free);
    if (!decoded) return damaged();
    DecodedImage image{static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height), {}};
    image.rgba.assign(decoded.get(), decoded.get() + std::size_t{image.width} * image.height * 4);
    return image;
}

}  // namespace tessera::import
