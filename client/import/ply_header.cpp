#include "client/import/ply_header.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>

namespace tessera::import {
namespace {

constexpr std::string_view Spaces = " \t\r";

std::vector<std::string_view> words_of(std::string_view line) {
    std::vector<std::string_view> words;
    while (true) {
        const std::size_t begin = line.find_first_not_of(Spaces);
        if (begin == line.npos) return words;
        const std::size_t end = std::min(line.find_first_of(Spaces, begin), line.size());
        words.push_back(line.substr(begin, end - begin));
        line.remove_prefix(end);
    }
}

std::optional<PlyType> type_of(std::string_view word) {
    constexpr std::array<std::array<std::string_view, 2>, 8> Names{{{"char", "int8"},
                                                                    {"uchar", "uint8"},
                                                                    {"short", "int16"},
                                                                    {"ushort", "uint16"},
                                                                    {"int", "int32"},
                                                                    {"uint", "uint32"},
                                                                    {"float", "float32"},
                                                                    {"double", "float64"}}};
    for (std::size_t i = 0; i < Names.size(); ++i) {
        if (word == Names[i][0] || word == Names[i][1]) return static_cast<PlyType>(i);
    }
    return std::nullopt;
}

std::optional<PlyEncoding> encoding_of(std::string_view word) {
    if (word == "ascii") return PlyEncoding::Ascii;
    if (word == "binary_little_endian") return PlyEncoding::LittleEndian;
    if (word == "binary_big_endian") return PlyEncoding::BigEndian;
    return std::nullopt;
}

std::optional<PlyProperty> property_of(const std::vector<std::string_view>& words) {
    PlyProperty property;
    property.is_list = words.size() == 5 && words[1] == "list";
    if (!property.is_list && words.size() != 3) return std::nullopt;
    const auto type = type_of(words[property.is_list ? 3 : 1]);
    const auto count_type = property.is_list ? type_of(words[2]) : PlyType::UInt8;
    if (!type || !count_type || *count_type >= PlyType::Float) return std::nullopt;
    property.name = words.back();
    property.type = *type;
    property.count_type = *count_type;
    return property;
}

tl::unexpected<Error> incomplete(const std::string& cause) {
    return failure(ErrorCode::InvalidInput,
                   "it is not a complete PLY file (" + cause + "): copy or export it again");
}

}  // namespace

std::size_t byte_size(PlyType type) {
    constexpr std::array<std::size_t, 8> Sizes{1, 1, 2, 2, 4, 4, 4, 8};
    return Sizes[static_cast<std::size_t>(type)];
}

Expected<PlyHeader> read_ply_header(std::string_view file) {
    if (!file.starts_with("ply\n") && !file.starts_with("ply\r\n"))
        return incomplete("it does not begin with 'ply'");
    PlyHeader header;
    bool has_format = false;
    for (std::size_t at = file.find('\n') + 1; at < file.size();) {
        const std::size_t end = std::min(file.find('\n', at), file.size());
        const std::string_view line = file.substr(at, end - at);
        const std::vector<std::string_view> words = words_of(line);
        at = std::min(end + 1, file.size());
        if (words.empty() || words[0] == "comment" || words[0] == "obj_info") continue;
        if (words[0] == "end_header") {
            if (!has_format) return incomplete("its header lacks the format");
            header.byte_size = at;
            return header;
        }
        const auto encoding =
            words[0] == "format" && words.size() == 3 ? encoding_of(words[1]) : std::nullopt;
        const auto property = words[0] == "property" ? property_of(words) : std::nullopt;
        if (encoding) {
            header.encoding = *encoding;
            has_format = true;
        } else if (words[0] == "element" && words.size() == 3) {
            PlyElement element{std::string(words[1]), 0, {}};
            const char* last = words[2].data() + words[2].size();
            const auto [stop, error] = std::from_chars(words[2].data(), last, element.count);
            if (error != std::errc() || stop != last || element.count > file.size()) {
                return incomplete("its header declares more elements than the file can hold");
            }
            header.elements.push_back(std::move(element));
        } else if (property && !header.elements.empty()) {
            header.elements.back().properties.push_back(*property);
        } else if (words[0] == "format" || words[0] == "element" || words[0] == "property") {
            return incomplete("its header has the invalid line '" + std::string(line.substr(0, 60)) + "'");
        }
    }
    return incomplete("its header has no end");
}

}  // namespace tessera::import
