#include "client/display_file/pfm.h"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <string_view>

#include "client/display_file/file_bytes.h"
#include "mediator/display/display.h"
#include "mediator/picture/png_reader.h"

namespace tessera::display_file {

namespace {

tl::unexpected<Error> refuse(const std::string& name, const std::string& why) {
    return failure(ErrorCode::InvalidInput, name + ": " + why);
}

bool is_space(char c) {
    return c == ' ' || c == '\n' || c == '\r' || c == '\t';
}

// The next word of the header, also consuming one white space after it; empty at the end.
std::string_view next_word(std::string_view& rest) {
    while (!rest.empty() && is_space(rest.front())) rest.remove_prefix(1);
    const auto end = std::ranges::find_if(rest, is_space);
    const std::string_view word = rest.substr(0, std::size_t(end - rest.begin()));
    rest.remove_prefix(std::min(word.size() + 1, rest.size()));
    return word;
}

template <class Number>
std::optional<Number> number(std::string_view word) {
    Number value{};
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc{} || end != word.data() + word.size()) return std::nullopt;
    return value;
}

struct Header {
    std::uint32_t columns = 0, rows = 0, components = 0;
    bool is_big_endian = false;
    std::size_t begin = 0;  // of the numbers
};

std::optional<Header> parse_header(std::string_view text) {
    constexpr std::size_t LongestHeader = 128;
    std::string_view rest = text.substr(0, LongestHeader);
    const std::string_view kind = next_word(rest);
    const auto columns = number<std::uint32_t>(next_word(rest)),
               rows = number<std::uint32_t>(next_word(rest));
    const auto scale = number<double>(next_word(rest));
    if ((kind != "PF" && kind != "Pf") || !columns || !rows || !scale || *scale == 0.0 || std::isnan(*scale))
        return std::nullopt;
    return Header{*columns, *rows, kind == "PF" ? 3u : 1u, *scale > 0.0,
                  std::min(text.size(), LongestHeader) - rest.size()};
}

}  // namespace

Expected<LoadedGrid> parse_pfm(std::span<const std::byte> bytes, const std::string& name) {
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    const std::optional<Header> header = parse_header(text);
    if (!header)
        return refuse(
            name, "is not a PFM: it must begin with 'PF' or 'Pf', width, height and a scale other than 0");
    if (header->columns == 0 || header->rows == 0 || header->columns > display::MaxEdge ||
        header->rows > display::MaxEdge)
        return refuse(name, "has " + std::to_string(header->columns) + " x " + std::to_string(header->rows) +
                                " nodes; 1 to " + std::to_string(display::MaxEdge) + " a side can be used");
    const std::size_t count = std::size_t{header->columns} * header->rows * header->components;
    if (bytes.size() - header->begin != 4 * count)
        return refuse(name, "has " + std::to_string(bytes.size() - header->begin) +
                                " bytes of values instead of " + std::to_string(4 * count) +
                                ": write it again");
    LoadedGrid grid{header->columns, header->rows, header->components, std::vector<float>(count)};
    std::memcpy(grid.values.data(), bytes.data() + header->begin, 4 * count);
    if (header->is_big_endian)
        for (float& value : grid.values)
            value = std::bit_cast<float>(__builtin_bswap32(std::bit_cast<std::uint32_t>(value)));
    const auto endless = std::ranges::find_if(grid.values, [](float value) { return std::isinf(value); });
    if (endless != grid.values.end()) {
        const auto node = std::size_t(endless - grid.values.begin()) / header->components;
        return refuse(name, "holds an infinite number at column " + std::to_string(node % header->columns) +
                                ", row " + std::to_string(node / header->columns) +
                                ": use NaN for points that are not visible");
    }
    if (std::ranges::all_of(grid.values, [](float value) { return std::isnan(value); }))
        return refuse(name, "holds only NaN");
    return grid;
}

Expected<LoadedGrid> load_pfm(const std::string& path) {
    const auto bytes = read_file(path, MostCalibrationBytes);
    if (!bytes) return tl::unexpected(bytes.error());
    return parse_pfm(*bytes, path);
}

Expected<LoadedGrid> parse_weights(std::span<const std::byte> bytes, const std::string& name, double gamma) {
    LoadedGrid grid;
    if (!bytes.empty() && bytes[0] == std::byte{'P'}) {
        auto loaded = parse_pfm(bytes, name);
        if (!loaded) return loaded;
        grid = std::move(*loaded);
    } else {
        auto image = picture::read_png(bytes);
        if (!image) return refuse(name, std::string(image.error().what()) + "; weights are PNG or PFM");
        grid = {image->width, image->height, image->components, std::move(image->values)};
        for (float& value : grid.values) value = static_cast<float>(std::pow(double{value}, gamma));
    }
    std::vector<float> means(std::size_t{grid.columns} * grid.rows);
    for (std::size_t i = 0; i < means.size(); ++i) {
        double sum = 0.0;
        for (std::size_t c = 0; c < grid.components; ++c) sum += grid.values[i * grid.components + c];
        means[i] = static_cast<float>(sum / grid.components);
        if (!(means[i] >= 0.0f && means[i] <= 1.0f))
            return refuse(name, "holds a weight that is not in 0 to 1 at column " +
                                    std::to_string(i % grid.columns) + ", row " +
                                    std::to_string(i / grid.columns));
    }
    return LoadedGrid{grid.columns, grid.rows, 1, std::move(means)};
}

Expected<LoadedGrid> load_weights(const std::string& path) {
    const auto bytes = read_file(path, MostCalibrationBytes);
    if (!bytes) return tl::unexpected(bytes.error());
    return parse_weights(*bytes, path, 1.0);
}

}  // namespace tessera::display_file
