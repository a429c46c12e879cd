#include "client/import/ply_import.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <span>

#include "client/import/local_files.h"
#include "client/import/ply_header.h"

namespace tessera::import {
namespace {

[[noreturn]] void reject_ply(const std::string& cause) {
    throw Error(ErrorCode::InvalidInput,
                "it is not a complete PLY file (" + cause + "): copy or export it again");
}

// Reads values one after another in any encoding.
class PlyData {
  public:
    PlyData(std::string_view bytes, PlyEncoding encoding) : rest_(bytes), encoding_(encoding) {}

    double next(PlyType type) { return encoding_ == PlyEncoding::Ascii ? next_word() : next_binary(type); }
    std::size_t bytes_left() const { return rest_.size(); }

  private:
    double next_word() {
        const std::size_t begin = rest_.find_first_not_of(" \t\r\n");
        if (begin == rest_.npos) reject_ply("its data ends too early");
        rest_.remove_prefix(begin);
        double value = 0.0;
        const auto [stop, error] = std::from_chars(rest_.data(), rest_.data() + rest_.size(), value);
        if (error == std::errc::result_out_of_range) value = std::numeric_limits<double>::infinity();
        if (error == std::errc::invalid_argument) reject_ply("its data has a word that is not a number");
        rest_.remove_prefix(static_cast<std::size_t>(stop - rest_.data()));
        return value;
    }

    double next_binary(PlyType type) {
        const std::size_t size = byte_size(type);
        if (rest_.size() < size) reject_ply("its data ends too early");
        char bytes[8] = {};
        const bool turned = encoding_ == PlyEncoding::BigEndian;
        for (std::size_t i = 0; i < size; ++i) bytes[turned ? size - 1 - i : i] = rest_[i];
        rest_.remove_prefix(size);
        switch (type) {
            case PlyType::Int8:
                return as<std::int8_t>(bytes);
            case PlyType::UInt8:
                return as<std::uint8_t>(bytes);
            case PlyType::Int16:
                return as<std::int16_t>(bytes);
            case PlyType::UInt16:
                return as<std::uint16_t>(bytes);
            case PlyType::Int32:
                return as<std::int32_t>(bytes);
            case PlyType::UInt32:
                return as<std::uint32_t>(bytes);
            case PlyType::Float:
                return as<float>(bytes);
            case PlyType::Double:
                return as<double>(bytes);
        }
        return 0.0;
    }

    template <class T>
    static double as(const char* bytes) {
        T value;
        std::memcpy(&value, bytes, sizeof value);
        return static_cast<double>(value);
    }

    std::string_view rest_;
    PlyEncoding encoding_;
};

// The slot of a vertex property: 0-2 position, 3-5 normal, 6-7 texture coordinates, 8-11 colour; -1 =
// ignored.
int slot_of(const std::string& name) {
    constexpr std::string_view Names[] = {"x", "y", "z",   "nx",    "ny",   "nz",
                                          "u", "v", "red", "green", "blue", "alpha"};
    std::string_view known = name;
    if (known == "s" || known == "texture_u") known = "u";
    if (known == "t" || known == "texture_v") known = "v";
    const auto* found = std::find(std::begin(Names), std::end(Names), known);
    return found == std::end(Names) ? -1 : static_cast<int>(found - std::begin(Names));
}

double linear_from_srgb(double value) {
    return value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4);
}

double color_value(double value, PlyType type, bool is_alpha) {
    if (type >= PlyType::Float) return value;
    const double level = value / (std::pow(256.0, static_cast<double>(byte_size(type))) - 1.0);
    return is_alpha ? level : linear_from_srgb(level);
}

std::vector<double> read_list(PlyData& data, const PlyProperty& property) {
    const double count = data.next(property.count_type);
    if (!(count >= 0.0 && count <= static_cast<double>(data.bytes_left()) && count == std::floor(count))) {
        reject_ply("a list is longer than the data");
    }
    std::vector<double> values(static_cast<std::size_t>(count));
    for (double& value : values) value = data.next(property.type);
    return values;
}

void skip(PlyData& data, const PlyProperty& property) {
    if (property.is_list) {
        read_list(data, property);
    } else {
        data.next(property.type);
    }
}

void read_vertices(PlyData& data, const PlyElement& element, MeshData& mesh) {
    bool has[12] = {};
    for (const PlyProperty& property : element.properties) {
        if (const int slot = slot_of(property.name); slot >= 0 && !property.is_list) has[slot] = true;
    }
    if (!(has[0] && has[1] && has[2])) reject_ply("its vertices lack x, y or z");
    for (std::uint64_t i = 0; i < element.count; ++i) {
        float value[12] = {0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1};
        for (const PlyProperty& property : element.properties) {
            const int slot = property.is_list ? -1 : slot_of(property.name);
            if (slot < 0) {
                skip(data, property);
                continue;
            }
            const double number = data.next(property.type);
            value[slot] =
                static_cast<float>(slot < 8 ? number : color_value(number, property.type, slot == 11));
        }
        mesh.positions.emplace_back(value[0], value[1], value[2]);
        if (has[3] && has[4] && has[5]) mesh.normals.emplace_back(value[3], value[4], value[5]);
        if (has[6] && has[7]) mesh.tex_coords.emplace_back(value[6], 1.0f - value[7]);
        if (has[8] && has[9] && has[10]) mesh.colors.emplace_back(value[8], value[9], value[10], value[11]);
    }
}

void read_faces(PlyData& data, const PlyElement& element, MeshData& mesh) {
    constexpr std::uint32_t None = 0xffffffffu;  // never a valid vertex: rejected by check_and_repair
    std::vector<std::uint32_t> polygon;
    for (std::uint64_t i = 0; i < element.count; ++i) {
        for (const PlyProperty& property : element.properties) {
            if (!property.is_list || (property.name != "vertex_indices" && property.name != "vertex_index")) {
                skip(data, property);
                continue;
            }
            polygon.clear();
            for (const double index : read_list(data, property)) {
                const bool possible = index >= 0.0 && index < static_cast<double>(None);
                polygon.push_back(possible ? static_cast<std::uint32_t>(index) : None);
            }
            const std::vector<std::uint32_t> triangles = triangles_of_fan(polygon);
            mesh.indices.insert(mesh.indices.end(), triangles.begin(), triangles.end());
        }
    }
}

MeshData read(std::string_view file) {
    const Expected<PlyHeader> header = read_ply_header(file);
    if (!header) throw header.error();
    MeshData mesh;
    PlyData data(file.substr(header->byte_size), header->encoding);
    for (const PlyElement& element : header->elements) {
        if (element.name == "vertex") {
            read_vertices(data, element, mesh);
        } else if (element.name == "face") {
            read_faces(data, element, mesh);
        } else {
            for (std::uint64_t i = 0; i < element.count; ++i) {
                for (const PlyProperty& property : element.properties) skip(data, property);
            }
        }
    }
    if (mesh.indices.empty())
        throw Error(ErrorCode::InvalidInput, "it has only points: there is nothing to render");
    return mesh;
}

}  // namespace

void import_ply(const std::filesystem::path& file, SceneBuilder& builder) {
    const auto bytes = read_whole_file(file);
    if (!bytes) throw bytes.error();
    MeshData mesh = read({reinterpret_cast<const char*>(bytes->data()), bytes->size()});
    const std::string name = file.stem().string();
    ObjectId geometry;
    try {
        for (const std::string& repair : check_and_repair(mesh))
            builder.notice("mesh '" + name + "': " + repair);
        scene::Material material;
        material.name = "default";
        material.double_sided = true;
        if (!mesh.colors.empty()) material.base_color = glm::vec4(1.0f);
        geometry = builder.add_geometry(name, builder.add(std::move(material)), mesh);
    } catch (const Error& error) {
        if (error.code() != ErrorCode::InvalidInput) throw;
        builder.notice("mesh '" + name + "' is invalid (" + error.what() +
                       "): a magenta box replaces it; export it again");
        geometry = builder.placeholder_geometry();
    }
    scene::Transform transform;
    transform.name = name;
    transform.children = {geometry};
    builder.result().root.children = {builder.add(std::move(transform))};
}

}  // namespace tessera::import
