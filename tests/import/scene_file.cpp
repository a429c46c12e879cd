#include "tests/import/scene_file.h"

#include <unistd.h>

#include <atomic>
#include <fstream>

namespace tessera::import {
namespace {

void append_u32(std::string& to, std::size_t value) {
    for (int shift = 0; shift < 32; shift += 8) to.push_back(static_cast<char>(value >> shift));
}

void append_big_endian(std::string& to, std::uint32_t value) {
    for (int shift = 24; shift >= 0; shift -= 8) to.push_back(static_cast<char>(value >> shift));
}

std::uint32_t crc32(std::string_view bytes) {
    std::uint32_t crc = 0xffffffffu;
    for (const char c : bytes) {
        crc ^= static_cast<unsigned char>(c);
        for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ (crc & 1 ? 0xedb88320u : 0u);
    }
    return ~crc;
}

void append_chunk(std::string& to, const std::string& type, const std::string& data) {
    append_big_endian(to, static_cast<std::uint32_t>(data.size()));
    to += type + data;
    append_big_endian(to, crc32(type + data));
}

}  // namespace

TestFolder::TestFolder() {
    static std::atomic<int> count{0};
    path_ = std::filesystem::temp_directory_path() /
            ("tessera-import-" + std::to_string(::getpid()) + "-" + std::to_string(count++));
    std::filesystem::create_directories(path_);
}

TestFolder::~TestFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
}

std::filesystem::path TestFolder::write(const std::string& name, std::string_view bytes) const {
    const std::filesystem::path file = path_ / name;
    std::filesystem::create_directories(file.parent_path());
    std::ofstream(file, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    return file;
}

int SceneFile::add(const std::string& array, const std::string& element) {
    arrays_[array].push_back(element);
    return static_cast<int>(arrays_[array].size()) - 1;
}

int SceneFile::view_of_bytes(std::string_view bytes, int stride) {
    const std::size_t offset = buffer_.size();
    buffer_.append(bytes);
    buffer_.resize((buffer_.size() + 3) / 4 * 4, '\0');
    return add("bufferViews", R"({"buffer":0,"byteOffset":)" + std::to_string(offset) + R"(,"byteLength":)" +
                                  std::to_string(bytes.size()) +
                                  (stride ? R"(,"byteStride":)" + std::to_string(stride) : "") + "}");
}

int SceneFile::accessor(int view, Component component, const std::string& type, std::size_t count,
                        const std::string& extra) {
    return add("accessors", R"({"bufferView":)" + std::to_string(view) + R"(,"componentType":)" +
                                std::to_string(static_cast<int>(component)) + R"(,"type":")" + type +
                                R"(","count":)" + std::to_string(count) + extra + "}");
}

int SceneFile::image(std::string_view encoded) {
    const int view = view_of_bytes(encoded);
    const int image =
        add("images", R"({"bufferView":)" + std::to_string(view) + R"(,"mimeType":"image/png"})");
    return add("textures", R"({"source":)" + std::to_string(image) + "}");
}

void SceneFile::add_triangle() {
    const int triangle = positions({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
    const int mesh =
        add("meshes", R"({"primitives":[{"attributes":{"POSITION":)" + std::to_string(triangle) + "}}]}");
    const int node = add("nodes", R"({"mesh":)" + std::to_string(mesh) + "}");
    add("scenes", R"({"nodes":[)" + std::to_string(node) + "]}");
}

std::string SceneFile::json(std::string_view buffer_uri) const {
    std::string text = R"({"asset":{"version":"2.0"})";
    if (!buffer_.empty()) {
        text += R"(,"buffers":[{"byteLength":)" + std::to_string(buffer_.size()) +
                (buffer_uri.empty() ? "" : R"(,"uri":")" + std::string(buffer_uri) + '"') + "}]";
    }
    for (const auto& [name, elements] : arrays_) {
        text += ",\"" + name + "\":[";
        for (std::size_t i = 0; i < elements.size(); ++i) text += (i ? "," : "") + elements[i];
        text += "]";
    }
    for (const auto& [name, value] : members_) text += ",\"" + name + "\":" + value;
    return text + "}";
}

std::string SceneFile::glb() const {
    return glb_of(json(), buffer_);
}

std::string SceneFile::gltf() const {
    return json("data:application/octet-stream;base64," + base64(buffer_));
}

std::string glb_of(std::string json, std::string buffer) {
    json.resize((json.size() + 3) / 4 * 4, ' ');
    buffer.resize((buffer.size() + 3) / 4 * 4, '\0');
    std::string glb = "glTF";
    append_u32(glb, 2);
    append_u32(glb, 20 + json.size() + (buffer.empty() ? 0 : 8 + buffer.size()));
    append_u32(glb, json.size());
    append_u32(glb, 0x4e4f534a);
    glb += json;
    if (!buffer.empty()) {
        append_u32(glb, buffer.size());
        append_u32(glb, 0x004e4942);
        glb += buffer;
    }
    return glb;
}

std::string base64(std::string_view bytes) {
    constexpr std::string_view Digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        std::uint32_t group = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            group = group << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
        }
        for (std::size_t k = 0; k < 4; ++k) {
            text.push_back(i + k <= bytes.size() ? Digits[group >> (18 - 6 * k) & 63] : '=');
        }
    }
    return text;
}

std::string png(std::uint32_t width, std::uint32_t height, glm::u8vec4 color, std::uint32_t claimed_width,
                std::uint32_t claimed_height) {
    std::string raw;
    for (std::uint32_t y = 0; y < height; ++y) {
        raw.push_back(0);  // no filter
        for (std::uint32_t x = 0; x < width; ++x) {
            for (int k = 0; k < 4; ++k) raw.push_back(static_cast<char>(color[k]));
        }
    }
    std::string zlib = "\x78\x01";
    zlib.push_back(1);  // one stored block, the last
    const auto length = static_cast<std::uint16_t>(raw.size());
    for (const std::uint16_t value : {length, static_cast<std::uint16_t>(~length)}) {
        zlib.push_back(static_cast<char>(value & 255));
        zlib.push_back(static_cast<char>(value >> 8));
    }
    zlib += raw;
    std::uint32_t a = 1, b = 0;
    for (const char c : raw) {
        a = (a + static_cast<unsigned char>(c)) % 65521;
        b = (b + a) % 65521;
    }
    append_big_endian(zlib, b << 16 | a);

    std::string header;
    append_big_endian(header, claimed_width ? claimed_width : width);
    append_big_endian(header, claimed_height ? claimed_height : height);
    header += std::string("\x08\x06\x00\x00\x00", 5);  // eight bits, RGBA
    std::string file = "\x89PNG\r\n\x1a\n";
    append_chunk(file, "IHDR", header);
    append_chunk(file, "IDAT", zlib);
    append_chunk(file, "IEND", "");
    return file;
}

}  // namespace tessera::import
