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

    bool read_header() {
        if (setjmp(png_jmpbuf(png_)) != 0) return false;
        png_read_info(png_, info_);
        png_set_expand(png_);
        png_set_strip_alpha(png_);
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
    std::size_t row_bytes() const { return png_get_rowbytes(png_, info_); }
    std::string message() const { return failure_.message; }

  private:
    Failure failure_;
    png_structp png_;
    png_infop info_;
};

}  // namespace

Expected<frame::Image> read_png(std::span<const std::byte> bytes) {
    if (bytes.size() < 8 || png_sig_cmp(reinterpret_cast<png_const_bytep>(bytes.data()), 0, 8) != 0)
        return failure(ErrorCode::InvalidInput, "it is not a PNG picture");
    Source source{bytes};
    PngReader reader(source);
    const auto damaged = [&] {
        return failure(ErrorCode::InvalidInput, "the PNG picture is damaged: " + reader.message());
    };
    if (!reader.read_header()) return damaged();
    // Deflate expands a byte to at most 1032; rejects headers that claim more before allocating.
    if (reader.row_bytes() * reader.height() > 1040 * bytes.size() + 65536)
        return failure(ErrorCode::InvalidInput, "the PNG picture claims more pixels than its bytes can hold");
    std::vector<std::uint8_t> values(reader.row_bytes() * reader.height());
    std::vector<png_bytep> rows;
    for (std::uint32_t y = 0; y < reader.height(); ++y)
        rows.push_back(values.data() + y * reader.row_bytes());
    if (!reader.read_rows(rows.data())) return damaged();

    frame::Image image(reader.width(), reader.height(), reader.components());
    const std::size_t per_row = std::size_t{image.width} * image.components;
    for (std::uint32_t y = 0; y < image.height; ++y)
        for (std::size_t i = 0; i < per_row; ++i)
            image.values[y * per_row + i] =
                reader.is_deep() ? static_cast<float>((rows[y][2 * i] << 8) + rows[y][2 * i + 1]) / 65535.0f
                                 : static_cast<float>(rows[y][i]) / 255.0f;
    return image;
}

}  // namespace tessera::picture
