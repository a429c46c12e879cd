#include "mediator/picture/hdr_reader.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <memory>
#include <vector>

#include "mediator/base/error.h"
#include "mediator/picture/exr_reader.h"

#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#define STBI_NO_STDIO
#define STBI_ONLY_HDR
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wsign-compare"
#pragma GCC diagnostic ignored "-Wshadow"
#include <stb/stb_image.h>
#pragma GCC diagnostic pop

namespace tessera::picture {

namespace {

std::vector<unsigned char> bytes_of(const std::string& path, const std::string& named) {
    std::error_code ignored;
    if (!std::filesystem::exists(path, ignored))
        throw Error(ErrorCode::NotFound, named + "there is no such file: check the name");
    if (!std::filesystem::is_regular_file(path, ignored))
        throw Error(ErrorCode::InvalidInput, named + "it is not a regular file: name a file");
    if (std::filesystem::file_size(path, ignored) > std::uintmax_t{std::numeric_limits<int>::max()})
        throw Error(ErrorCode::InvalidInput, named + "it has more than 2 GiB: scale it down");
    std::ifstream file(path, std::ios::binary);
    std::vector<unsigned char> bytes{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
    if (!file.eof() || file.bad()) throw Error(ErrorCode::Io, named + "it cannot be read: check its rights");
    return bytes;
}

}  // namespace

frame::Image read_hdr(const std::string& path) {
    const std::string named = "picture '" + path + "': ";
    const std::vector<unsigned char> bytes = bytes_of(path, named);
    const int size = static_cast<int>(bytes.size());
    int width = 0, height = 0, components = 0;
    if (!stbi_is_hdr_from_memory(bytes.data(), size) ||
        !stbi_info_from_memory(bytes.data(), size, &width, &height, &components) || width < 1 || height < 1) {
        throw Error(ErrorCode::InvalidInput, named + "it is damaged or not a Radiance picture: convert it");
    }
    // The densest form stores runs of 127 equal bytes in two, for each of four bytes of a pixel.
    const std::int64_t pixels = std::int64_t{width} * height;
    const std::string claim =
        "it claims " + std::to_string(width) + " x " + std::to_string(height) + " pixels, ";
    if (pixels > MaxPicturePixels)
        throw Error(ErrorCode::InvalidInput, named + claim + "more than are read: scale it down");
    if (pixels / 16 > std::int64_t{size}) {
        throw Error(ErrorCode::InvalidInput,
                    named + claim + "but has only " + std::to_string(size) + " bytes: write it again");
    }
    const std::unique_ptr<float, decltype(&stbi_image_free)> decoded(
        stbi_loadf_from_memory(bytes.data(), size, &width, &height, &components, 3), &stbi_image_free);
    if (!decoded) {
        throw Error(ErrorCode::InvalidInput,
                    named + "it is damaged (" + stbi_failure_reason() + "): write it again");
    }
    frame::Image image(static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height), 3);
    std::copy_n(decoded.get(), image.values.size(), image.values.begin());
    return image;
}

}  // namespace tessera::picture
