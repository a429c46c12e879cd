#include "mediator/picture/hdr_reader.h"

#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string_view>
#include <vector>

#include "mediator/base/error.h"

namespace tessera::picture {

namespace {

using Rgbe = std::array<std::uint8_t, 4>;

Error damaged_hdr(const std::string& reason) {
    return Error(ErrorCode::InvalidInput, reason + ": write it again");
}

// Reads forward and never past the end.
class HdrBytes {
  public:
    explicit HdrBytes(std::span<const std::byte> bytes) : bytes_(bytes) {}
    std::size_t left() const { return bytes_.size() - next_; }
    std::uint8_t byte() {
        if (left() == 0) throw damaged_hdr("it ends in the middle of its pixels");
        return static_cast<std::uint8_t>(bytes_[next_++]);
    }
    Rgbe read_rgbe() { return {byte(), byte(), byte(), byte()}; }
    void back(std::size_t count) { next_ -= count; }
    std::string line() {
        constexpr std::size_t LongestLine = 4096;
        std::string text;
        while (left() > 0 && text.size() < LongestLine) {
            const char letter = static_cast<char>(byte());
            if (letter == '\n') return text;
            text += letter;
        }
        throw damaged_hdr("its header has no end");
    }

  private:
    std::span<const std::byte> bytes_;
    std::size_t next_ = 0;
};

struct Size {
    std::int64_t width = 0, height = 0;
};

std::int64_t number(std::string_view text) {
    std::int64_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    return error == std::errc() && end == text.data() + text.size() ? value : 0;
}

Size read_header(HdrBytes& reader, const PictureLimits& limits) {
    const std::string magic = reader.left() > 2 ? reader.line() : "";
    if (magic != "#?RADIANCE" && magic != "#?RGBE") throw damaged_hdr("it is not a Radiance picture");
    bool rgbe = false;
    for (std::string line = reader.line(); !line.empty(); line = reader.line())
        rgbe = rgbe || line == "FORMAT=32-bit_rle_rgbe";
    if (!rgbe) throw damaged_hdr("its format is not 32-bit_rle_rgbe");
    const std::string line = reader.line();
    const std::size_t x = line.find(" +X ");
    if (line.rfind("-Y ", 0) != 0 || x == std::string::npos)
        throw damaged_hdr("its rows do not run from the top");
    const Size size{number(std::string_view(line).substr(x + 4)),
                    number(std::string_view(line).substr(3, x - 3))};
    if (size.width < 1 || size.height < 1) throw damaged_hdr("its size is not two positive numbers");
    if (size.width > limits.side || size.height > limits.side || size.width * size.height > limits.pixels) {
        throw Error(ErrorCode::InvalidInput, "it claims " + std::to_string(size.width) + " x " +
                                                 std::to_string(size.height) + " pixels, more than the " +
                                                 std::to_string(limits.pixels) +
                                                 " that are supported: scale it down");
    }
    // A row needs a pixel, a second one to repeat it up to 255 times, and a third beyond.
    const std::int64_t least = size.width == 1 ? 4 : size.width <= 256 ? 8 : 12;
    if (least * size.height > static_cast<std::int64_t>(reader.left()))
        throw damaged_hdr("it is shorter than its size claims");
    return size;
}

// The four components one after another, each as runs and literal sequences.
void read_components(HdrBytes& reader, std::span<Rgbe> row) {
    for (std::size_t component = 0; component < 4; ++component) {
        for (std::size_t x = 0; x < row.size();) {
            const std::uint8_t code = reader.byte();
            const std::size_t count = code > 128 ? code - 128u : code;
            if (count == 0 || count > row.size() - x) throw damaged_hdr("a run does not fit into its row");
            const std::uint8_t repeated = code > 128 ? reader.byte() : std::uint8_t{0};
            for (const std::size_t end = x + count; x < end; ++x)
                row[x][component] = code > 128 ? repeated : reader.byte();
        }
    }
}

// Whole pixels; (1, 1, 1, n) repeats the previous one n times; consecutive repeats are multiplied by 256 each.
void read_pixels(HdrBytes& reader, std::span<Rgbe> row) {
    unsigned shift = 0;
    for (std::size_t x = 0; x < row.size();) {
        const Rgbe pixel = reader.read_rgbe();
        if (pixel[0] != 1 || pixel[1] != 1 || pixel[2] != 1) {
            row[x++] = pixel;
            shift = 0;
            continue;
        }
        const std::size_t count = shift > 16 ? row.size() + 1 : std::size_t{pixel[3]} << shift;
        if (x == 0 || count > row.size() - x) throw damaged_hdr("a run does not fit into its row");
        for (const std::size_t end = x + count; x < end; ++x) row[x] = row[x - 1];
        shift += 8;
    }
}

void read_row(HdrBytes& reader, std::span<Rgbe> row) {
    if (row.size() < 8 || row.size() > 0x7fff) return read_pixels(reader, row);
    const Rgbe start = reader.read_rgbe();
    if (start[0] == 2 && start[1] == 2 && start[2] < 128) {
        if (start[2] * 256u + start[3] != row.size())
            throw damaged_hdr("a row has another width than the picture");
        return read_components(reader, row);
    }
    reader.back(start.size());
    read_pixels(reader, row);
}

void decode(const Rgbe& pixel, std::span<float> rgb) {
    const float scale = pixel[3] == 0 ? 0.0f : std::ldexp(1.0f, pixel[3] - (128 + 8));
    for (std::size_t c = 0; c < 3; ++c) rgb[c] = static_cast<float>(pixel[c]) * scale;
}

}  // namespace

bool is_hdr(std::span<const std::byte> bytes) {
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    return text.starts_with("#?RADIANCE\n") || text.starts_with("#?RGBE\n");
}

frame::Image decode_hdr(std::span<const std::byte> bytes, const PictureLimits& limits) {
    HdrBytes reader(bytes);
    const Size size = read_header(reader, limits);
    frame::Image image(static_cast<std::uint32_t>(size.width), static_cast<std::uint32_t>(size.height), 3);
    std::vector<Rgbe> row(image.width);
    for (std::size_t y = 0; y < image.height; ++y) {
        read_row(reader, row);
        for (std::size_t x = 0; x < row.size(); ++x) decode(row[x], image.pixel(y * image.width + x));
    }
    return image;
}

frame::Image read_hdr(const std::string& path) {
    const std::string named = "picture '" + path + "': ";
    std::error_code ignored;
    if (!std::filesystem::exists(path, ignored))
        throw Error(ErrorCode::NotFound, named + "there is no such file: check the name");
    if (!std::filesystem::is_regular_file(path, ignored))
        throw Error(ErrorCode::InvalidInput, named + "it is not a regular file: name a file");
    std::ifstream file(path, std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
    if (!file || file.bad()) throw Error(ErrorCode::Io, named + "it cannot be read: check its rights");
    try {
        return decode_hdr(std::as_bytes(std::span(bytes)));
    } catch (const Error& error) {
        throw Error(error.code(), named + error.what());
    }
}

}  // namespace tessera::picture
