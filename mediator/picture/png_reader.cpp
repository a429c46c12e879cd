#include "mediator/picture/png_reader.h"

#include <png.h>

#include <csetjmp>
#include <cstring>
#include <string>

namespace tessera::picture {

namespace {

constexpr png_uint_32 MaxSide = 16384;  // pixels per side

struct Source {
    std::span<const std::byte> rest;
};

void read_bytes(png_structp png, png_bytep out, std::size_t count) {
    auto& source = *static_cast<Source*>(png_get_io_ptr(png));
    if (count > source.rest.size()) png_error(png, "the file ends too early");
    std::memcpy(out, source.rest.data(), count);
    source.rest = source.rest.subspan(count);
}

struct Failure {
    char message[128] = "";
};

[[noreturn]] void fail(png_structp png, png_const_charp message) {
    auto& failure = *static_cast<Failure*>(png_get_error_ptr(png));
    std::strncpy(failure.message, message, sizeof failure.message - 1);
    png_longjmp(png, 1);
}

void ignore_warning(png_structp, png_const_charp) {}

// Functions that libpng may longjmp out of have no objects with destructors.
class PngReader {
  public:
    explicit PngReader(Source& source)
        : png_(png_create_read_struct(PNG_LIBPNG_VER_STRING, &failure_, fail, ignore_warning)),
          info_(png_ != nullptr ? png_create_info_struct(png_) : nullptr) {
        if (info_ == nullptr) throw Error(ErrorCode::OutOfMemory, "no memory to read a PNG");
        png_set_read_fn(png_, &source, read_bytes);
        png_set_user_limits(png_, MaxSide, MaxSide);
    }
    ~PngReader() { png_destroy_read_struct(&png_, &info_, nullptr); }
    PngReader(const PngReader&) = delete;
    PngReader& operator=(const PngReader&) = delete;

    enum class Format { WithoutAlpha, Rgba8 };
    // Before the conversion to the format.
    bool read_header() {
        if (setjmp(png_jmpbuf(png_)) != 0) return false;
        png_read_info(png_, info_);
        return true;
    }
    bool convert_to(Format format) {
        if (setjmp(png_jmpbuf(png_)) != 0) return false;
        png_set_expand(png_);
        if (format == Format::Rgba8) {
            png_set_strip_16(png_);
            png_set_gray_to_rgb(png_);
            png_set_add_alpha(png_, 0xff, PNG_FILLER_AFTER);
        } else {
            png_set_strip_alpha(png_);
        }
        png_read_update_info(png_, info_);
        return true;
    }
    bool read_rows(png_bytepp rows) {
        if (setjmp(png_jmpbuf(png_)) != 0) return false;
        png_read_image(png_, rows);
        return true;
    }

    std::uint32_t width() const { return png_get_image_width(png_, info_); }
    std::uint32_t height() const { return png_get_image_height(png_, info_); }
    std::uint32_t components() const { return png_get_channels(png_, info_); }
    bool is_deep() const { return png_get_bit_depth(png_, info_) == 16; }
    bool has_alpha() const {
        return (png_get_color_type(png_, info_) & PNG_COLOR_MASK_ALPHA) != 0 ||
               png_get_valid(png_, info_, PNG_INFO_tRNS) != 0;
    }
    std::size_t row_bytes() const { return png_get_rowbytes(png_, info_); }
    std::string message() const { return failure_.message; }

  private:
    Failure failure_;
    png_structp png_;
    png_infop info_;
};

tl::unexpected<Error> damaged_png(const PngReader& reader) {
    return failure(ErrorCode::InvalidInput,
                   "the PNG picture is damaged (" + reader.message() + "): write it again");
}

// Reads the header and checks it before pixels are allocated.
Expected<void> start(PngReader& reader, std::size_t byte_size, const PictureLimits& limits) {
    if (!reader.read_header()) return damaged_png(reader);
    const std::string claim = "the image claims " + std::to_string(reader.width()) + " x " +
                              std::to_string(reader.height()) + " pixels, ";
    const std::int64_t width = reader.width(), height = reader.height();
    if (width > limits.side || height > limits.side || width * height > limits.pixels)
        return failure(ErrorCode::InvalidInput, claim + "more than the " + std::to_string(limits.pixels) +
                                                    " that are supported: scale it down");
    constexpr std::size_t DeflateRatio = 1032;  // RFC 1951: at most 258 bytes per two bits
    if (reader.row_bytes() * reader.height() / DeflateRatio > byte_size)
        return failure(ErrorCode::InvalidInput,
                       claim + "but has only " + std::to_string(byte_size) + " bytes: write it again");
    return {};
}

// The pixels in a format, row by row.
Expected<std::vector<std::uint8_t>> pixels(PngReader& reader, PngReader::Format format) {
    if (!reader.convert_to(format)) return damaged_png(reader);
    std::vector<std::uint8_t> values(reader.row_bytes() * reader.height());
    std::vector<png_bytep> rows;
    for (std::uint32_t y = 0; y < reader.height(); ++y)
        rows.push_back(values.data() + y * reader.row_bytes());
    if (!reader.read_rows(rows.data())) return damaged_png(reader);
    return values;
}

// Without alpha: to [0, 1].
Expected<frame::Image> floats(PngReader& reader) {
    const auto values = pixels(reader, PngReader::Format::WithoutAlpha);
    if (!values) return tl::unexpected<Error>(values.error());
    frame::Image image(reader.width(), reader.height(), reader.components());
    const std::size_t per_row = std::size_t{image.width} * image.components;
    for (std::uint32_t y = 0; y < image.height; ++y)
        for (std::size_t i = 0; i < per_row; ++i) {
            const std::uint8_t* row = values->data() + y * reader.row_bytes();
            image.values[y * per_row + i] =
                reader.is_deep() ? static_cast<float>((row[2 * i] << 8) + row[2 * i + 1]) / 65535.0f
                                 : static_cast<float>(row[i]) / 255.0f;
        }
    return image;
}

}  // namespace

bool is_png(std::span<const std::byte> bytes) {
    return bytes.size() >= 8 && png_sig_cmp(reinterpret_cast<png_const_bytep>(bytes.data()), 0, 8) == 0;
}

Expected<RgbaImage> read_png_rgba(std::span<const std::byte> bytes, const PictureLimits& limits) {
    if (!is_png(bytes)) return failure(ErrorCode::InvalidInput, "it is not a PNG picture: write it again");
    Source source{bytes};
    PngReader reader(source);
    if (const auto started = start(reader, bytes.size(), limits); !started)
        return tl::unexpected<Error>(started.error());
    auto rgba = pixels(reader, PngReader::Format::Rgba8);
    if (!rgba) return tl::unexpected<Error>(rgba.error());
    return RgbaImage{reader.width(), reader.height(), std::move(*rgba)};
}

Expected<frame::Image> read_png(std::span<const std::byte> bytes) {
    if (!is_png(bytes)) return failure(ErrorCode::InvalidInput, "it is not a PNG picture: write it again");
    Source source{bytes};
    PngReader reader(source);
    constexpr PictureLimits Limits{.side = MaxSide, .pixels = std::int64_t{MaxSide} * MaxSide};
    if (const auto started = start(reader, bytes.size(), Limits); !started)
        return tl::unexpected<Error>(started.error());
    return floats(reader);
}

Expected<std::optional<frame::Image>> read_png16(std::span<const std::byte> bytes,
                                                 const PictureLimits& limits) {
    if (!is_png(bytes)) return std::nullopt;
    Source source{bytes};
    PngReader reader(source);
    if (const auto started = start(reader, bytes.size(), limits); !started)
        return tl::unexpected<Error>(started.error());
    if (!reader.is_deep() || reader.has_alpha()) return std::nullopt;
    Expected<frame::Image> image = floats(reader);
    if (!image) return tl::unexpected<Error>(image.error());
    if (image->components == 3) return std::move(*image);
    frame::Image gray(image->width, image->height, 3);
    for (std::size_t i = 0; i < gray.values.size(); ++i) gray.values[i] = image->values[i / 3];
    return gray;
}

}  // namespace tessera::picture
