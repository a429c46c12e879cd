#include "mediator/picture/png_writer.h"

#include <png.h>

#include "mediator/base/error.h"
#include "mediator/picture/atomic_file.h"

namespace tessera::picture {

void write_png(const std::string& path, std::uint32_t width, std::uint32_t height,
               std::span<const std::uint8_t> rgb) {
    write_atomically(path, [&](const std::string& temporary) {
        png_image image{};
        image.version = PNG_IMAGE_VERSION;
        image.width = width;
        image.height = height;
        image.format = PNG_FORMAT_RGB;
        if (png_image_write_to_file(&image, temporary.c_str(), 0, rgb.data(), 0, nullptr) == 0) {
            throw Error(ErrorCode::Io, "cannot write '" + path + "': " + image.message);
        }
    });
}

}  // namespace tessera::picture
