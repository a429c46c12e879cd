#include "client/import/image_decoder.h"

#include <algorithm>
#include <limits>
#include <memory>
#include <string>

#include "client/import/limits.h"

#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#define STBI_NO_STDIO
#define STBI_ONLY_PNG
#define STBI_ONLY_JPEG
#define STBI_ONLY_BMP
#define STBI_ONLY_TGA
#define STBI_ONLY_HDR
#define STBI_MAX_DIMENSIONS 16384
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wsign-compare"
#pragma GCC diagnostic ignored "-Wshadow"
#include <stb/stb_image.h>
#pragma GCC diagnostic pop

namespace tessera::import {
namespace {

// Upper bound of pixels per byte of the file. Deflate repeats at most 1032 bytes per byte of
// input, and a PNG pixel takes at least an eighth of a byte; a progressive JPEG spends at least one bit on 16
// x 16 pixels. The others store runs of at most 128 pixels in two bytes.
std::uint64_t pixels_per_byte(std::span<const unsigned char> bytes) {
    const bool png = bytes.size() > 1 && bytes[0] == 0x89 && bytes[1] == 'P';
    const bool jpeg = bytes.size() > 1 && bytes[0] == 0xff && bytes[1] == 0xd8;
    return png ? 1032 * 8 : jpeg ? 256 * 8 : 128;
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
    Size size;
    int components = 0;
    if (!stbi_info_from_memory(bytes.data(), static_cast<int>(bytes.size()), &size.width, &size.height,
                               &components) ||
        size.width <= 0 || size.height <= 0) {
        return failure(ErrorCode::InvalidInput,
                       "the image is damaged or neither PNG, JPEG, BMP, TGA nor HDR");
    }
    const std::string claim =
        "the image claims " + std::to_string(size.width) + " x " + std::to_string(size.height) + " pixels, ";
    if (static_cast<std::uint32_t>(size.width) > MaxImageEdge ||
        static_cast<std::uint32_t>(size.height) > MaxImageEdge || size.pixels() > MaxImagePixels) {
        return failure(ErrorCode::InvalidInput, claim + "more than the " + std::to_string(MaxImageEdge) +
                                                    " by " + std::to_string(MaxImagePixels / MaxImageEdge) +
                                                    " that are read");
    }
    if (size.pixels() / pixels_per_byte(bytes) > bytes.size()) {
        return failure(ErrorCode::InvalidInput,
                       claim + "but has only " + std::to_string(bytes.size()) + " bytes");
    }
    return size;
}

tl::unexpected<Error> damaged() {
    return failure(ErrorCode::InvalidInput,
                   "the image is damaged (" + std::string(stbi_failure_reason()) + ")");
}

}  // namespace

Expected<DecodedImage> decode_image(std::span<const unsigned char> bytes) {
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

Expected<frame::Image> decode_hdr(std::span<const unsigned char> bytes) {
    const Expected<Size> size = checked_size(bytes);
    if (!size) return tl::unexpected<Error>(size.error());
    const int byte_size = static_cast<int>(bytes.size());
    if (!stbi_is_hdr_from_memory(bytes.data(), byte_size)) {
        return failure(ErrorCode::InvalidInput, "the image is not a Radiance HDR image");
    }
    int width = 0, height = 0, components = 0;
    const std::unique_ptr<float, decltype(&stbi_image_free)> decoded(
        stbi_loadf_from_memory(bytes.data(), byte_size, &width, &height, &components, 3), &stbi_image_free);
    if (!decoded) return damaged();
    frame::Image image(static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height), 3);
    std::copy_n(decoded.get(), image.values.size(), image.values.begin());
    return image;
}

}  // namespace tessera::import
