#include "mediator/picture/picture_encoder.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <ImfStdIO.h>
#include <jpeglib.h>
#include <png.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <memory>

#include "mediator/base/error.h"
#include "mediator/picture/tone_map.h"

namespace tessera::picture {

namespace {

constexpr int JpegQuality = 92;

std::vector<std::byte> bytes_of(const void* data, std::size_t size) {
    const auto* first = static_cast<const std::byte*>(data);
    return {first, first + size};
}

frame::Image colors(const frame::Image& image) {
    frame::Image rgb(image.width, image.height, 3);
    for (std::size_t i = 0; i < image.pixel_count(); ++i)
        std::copy_n(image.pixel(i).begin(), 3, rgb.pixel(i).begin());
    return rgb;
}

// Straight colours: what a covered pixel would show if it were covered in full.
frame::Image straight(const frame::Image& image) {
    frame::Image rgb(image.width, image.height, 3);
    for (std::size_t i = 0; i < image.pixel_count(); ++i) {
        const float alpha = image.pixel(i)[3];
        for (std::size_t c = 0; c < 3; ++c) rgb.pixel(i)[c] = alpha > 0.0f ? image.pixel(i)[c] / alpha : 0.0f;
    }
    return rgb;
}

std::vector<std::byte> png(const frame::Image& image) {
    const bool has_alpha = image.components == 4;
    std::vector<std::uint8_t> pixels = tone_map(has_alpha ? straight(image) : image);
    if (has_alpha) {
        std::vector<std::uint8_t> rgba(image.pixel_count() * 4);
        for (std::size_t i = 0; i < image.pixel_count(); ++i) {
            std::copy_n(&pixels[3 * i], 3, &rgba[4 * i]);
            rgba[4 * i + 3] =
                static_cast<std::uint8_t>(std::lround(std::clamp(image.pixel(i)[3], 0.0f, 1.0f) * 255.0f));
        }
        pixels = std::move(rgba);
    }
    png_image header{};
    header.version = PNG_IMAGE_VERSION;
    header.width = image.width;
    header.height = image.height;
    header.format = has_alpha ? PNG_FORMAT_RGBA : PNG_FORMAT_RGB;
    header.flags = PNG_IMAGE_FLAG_FAST;  // a third of the time for a tenth more bytes
    png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(header);
    const auto buffer = std::make_unique_for_overwrite<std::byte[]>(size);
    if (png_image_write_to_memory(&header, buffer.get(), &size, 0, pixels.data(), 0, nullptr) == 0) {
        throw Error(ErrorCode::Io, std::string("cannot encode the picture as PNG: ") + header.message);
    }
    return bytes_of(buffer.get(), size);
}

[[noreturn]] void fail_jpeg(j_common_ptr info) {
    std::array<char, JMSG_LENGTH_MAX> text{};
    info->err->format_message(info, text.data());
    throw Error(ErrorCode::Io, std::string("cannot encode the picture as JPEG: ") + text.data());
}

struct JpegCompressor {
    jpeg_compress_struct info{};
    jpeg_error_mgr errors{};
    unsigned char* data = nullptr;
    unsigned long size = 0;

    JpegCompressor() {
        info.err = jpeg_std_error(&errors);
        errors.error_exit = fail_jpeg;
        jpeg_create_compress(&info);
        jpeg_mem_dest(&info, &data, &size);
    }
    ~JpegCompressor() {
        jpeg_destroy_compress(&info);
        std::free(data);
    }
    JpegCompressor(const JpegCompressor&) = delete;
    JpegCompressor& operator=(const JpegCompressor&) = delete;
};

std::vector<std::byte> jpeg(const frame::Image& image) {
    std::vector<std::uint8_t> pixels = tone_map(image.components == 4 ? colors(image) : image);
    JpegCompressor compressor;
    jpeg_compress_struct& info = compressor.info;
    info.image_width = image.width;
    info.image_height = image.height;
    info.input_components = 3;
    info.in_color_space = JCS_RGB;
    jpeg_set_defaults(&info);
    jpeg_set_quality(&info, JpegQuality, TRUE);
    jpeg_start_compress(&info, TRUE);
    for (std::uint32_t y = 0; y < image.height; ++y) {
        JSAMPROW row = &pixels[std::size_t{3} * image.width * y];
        jpeg_write_scanlines(&info, &row, 1);
    }
    jpeg_finish_compress(&info);
    return bytes_of(compressor.data, compressor.size);
}

std::vector<std::byte> exr(const frame::Image& image) {
    try {
        Imf::Header header(static_cast<int>(image.width), static_cast<int>(image.height));
        header.compression() = Imf::ZIPS_COMPRESSION;
        Imf::FrameBuffer buffer;
        const char* const names[] = {"R", "G", "B", "A"};
        auto* first = reinterpret_cast<char*>(const_cast<float*>(image.values.data()));  // only read
        const std::size_t stride = image.components * sizeof(float);
        for (std::uint32_t c = 0; c < image.components; ++c) {
            header.channels().insert(names[c], Imf::Channel(Imf::FLOAT));
            buffer.insert(names[c],
                          Imf::Slice(Imf::FLOAT, first + c * sizeof(float), stride, stride * image.width));
        }
        Imf::StdOSStream stream;
        {
            Imf::OutputFile file(stream, header);
            file.setFrameBuffer(buffer);
            file.writePixels(static_cast<int>(image.height));
        }
        const std::string text = stream.str();
        return bytes_of(text.data(), text.size());
    } catch (const std::exception& error) {
        throw Error(ErrorCode::Io, std::string("cannot encode the picture as OpenEXR: ") + error.what());
    }
}

}  // namespace

std::vector<std::byte> encode_picture(const frame::Image& image, FileFormat format) {
    switch (format) {
        case FileFormat::Png:
            return png(image);
        case FileFormat::Jpeg:
            return jpeg(image);
        case FileFormat::Exr:
            break;
    }
    return exr(image);
}

}  // namespace tessera::picture
