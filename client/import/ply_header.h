#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "mediator/base/error.h"

namespace tessera::import {

enum class PlyType { Int8, UInt8, Int16, UInt16, Int32, UInt32, Float, Double };
enum class PlyEncoding { Ascii, LittleEndian, BigEndian };

std::size_t byte_size(PlyType type);

struct PlyProperty {
    std::string name;
    PlyType type = PlyType::Float;        // of a value or of the items of a list
    PlyType count_type = PlyType::UInt8;  // of a list
    bool is_list = false;
};

struct PlyElement {
    std::string name;
    std::uint64_t count = 0;
    std::vector<PlyProperty> properties;
};

struct PlyHeader {
    PlyEncoding encoding = PlyEncoding::Ascii;
    std::vector<PlyElement> elements;
    std::size_t byte_size = 0;  // offset of the data
};

// InvalidInput if it is not a PLY file, has an invalid line, or more elements than the file has bytes.
Expected<PlyHeader> read_ply_header(std::string_view file);

}  // namespace tessera::import
