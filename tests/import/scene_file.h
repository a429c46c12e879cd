#pragma once

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <map>
#include <string>
#include <string_view>
#include <vector>

// Creates small scene files for tests in a temporary folder.
namespace tessera::import {

// A temporary folder, removed by the destructor.
class TestFolder {
  public:
    TestFolder();
    ~TestFolder();
    TestFolder(const TestFolder&) = delete;
    TestFolder& operator=(const TestFolder&) = delete;

    const std::filesystem::path& path() const { return path_; }
    std::filesystem::path write(const std::string& name, std::string_view bytes) const;  // returns the path

  private:
    std::filesystem::path path_;
};

enum class Component { Byte = 5120, UByte = 5121, Short = 5122, UShort = 5123, UInt = 5125, Float = 5126 };

// Collects arrays and JSON into a .glb, or a .gltf with its buffer as a data URI.
class SceneFile {
  public:
    // Appends the array to the buffer and creates a buffer view; returns its index.
    template <class T>
    int view(const std::vector<T>& values, int stride = 0) {
        return view_of_bytes({reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)},
                             stride);
    }
    int view_of_bytes(std::string_view bytes, int stride = 0);

    // `extra` is JSON such as ",\"normalized\":true".
    int accessor(int view, Component component, const std::string& type, std::size_t count,
                 const std::string& extra = "");
    int positions(const std::vector<glm::vec3>& values) {
        return accessor(view(values), Component::Float, "VEC3", values.size());
    }
    int indices(const std::vector<std::uint32_t>& values) {
        return accessor(view(values), Component::UInt, "SCALAR", values.size());
    }
    int image(std::string_view encoded);  // and a texture of the same index

    // Appends an element to a top-level array such as "meshes"; returns its index.
    int add(const std::string& array, const std::string& element);
    // Sets another top-level member, as JSON.
    void set(const std::string& member, const std::string& json) { members_[member] = json; }

    // A mesh of one triangle (0,0,0) (1,0,0) (0,1,0), a node with it and a scene of that node.
    void add_triangle();

    std::string json(std::string_view buffer_uri = {}) const;
    std::string glb() const;
    std::string gltf() const;  // self-contained
    const std::string& buffer() const { return buffer_; }

  private:
    std::string buffer_;
    std::map<std::string, std::vector<std::string>> arrays_;
    std::map<std::string, std::string> members_;
};

std::string glb_of(std::string json, std::string buffer);
std::string base64(std::string_view bytes);

// An RGBA PNG, stored without compression. `claimed_width` other than 0 is written to the header instead of
// the true width.
std::string png(std::uint32_t width, std::uint32_t height, glm::u8vec4 color, std::uint32_t claimed_width = 0,
                std::uint32_t claimed_height = 0);

}  // namespace tessera::import
