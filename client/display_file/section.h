#pragma once

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "client/display_file/document.h"

namespace tessera::display_file {

// One table of the file, read key by key. Throws Error{InvalidInput} with file, line, column, the object
// ("output 'left'") and the remedy. The value must outlive the section.
class Section {
  public:
    Section(const Value& value, std::string file, std::string object);

    // Sets its name in errors, once known.
    void call(std::string object) { object_ = std::move(object); }
    const std::string& object() const { return object_; }
    const std::string& file() const { return file_; }

    bool has(const std::string& key) const { return entry(key) != nullptr; }

    std::optional<std::string> text(const std::string& key);
    std::optional<double> number(const std::string& key, double least, double most);
    std::optional<std::int64_t> whole(const std::string& key, std::int64_t least, std::int64_t most);
    std::optional<bool> truth(const std::string& key);
    std::optional<glm::dvec2> pair(const std::string& key, double least, double most);
    std::optional<glm::dvec3> point(const std::string& key);      // metres, up to 10,000 km
    std::optional<glm::dvec3> direction(const std::string& key);  // unit length
    std::optional<std::vector<double>> numbers(const std::string& key, double least, double most);
    // [across, down], whole numbers.
    std::optional<std::array<std::uint32_t, 2>> counts(const std::string& key, std::uint32_t least,
                                                       std::uint32_t most);
    std::optional<std::array<std::uint32_t, 2>> size(const std::string& key);  // of a picture
    // The index of the word among the choices.
    std::optional<std::size_t> choice(const std::string& key, std::span<const std::string_view> words);
    std::optional<Section> section(const std::string& key);
    std::vector<Section> sections(const std::string& key);  // [[key]], or a single table
    std::optional<Value::Kind> kind(const std::string& key) const;

    // Registers keys that are read only in some cases.
    void knows(std::initializer_list<const char*> keys);
    // Call after all keys were read: reports the first unknown key, with the closest known one.
    void refuse_unknown() const;

    // Reports at the key, or at the table if the key is missing.
    [[noreturn]] void refuse(const std::string& key, const std::string& why) const;
    [[noreturn]] void refuse(const std::string& why) const;
    [[noreturn]] void require(const std::string& key) const;  // "needs ..."

  private:
    const Value* entry(const std::string& key) const;
    const Value* take(const std::string& key);
    const Value* take(const std::string& key, Value::Kind kind);
    double checked(const std::string& key, const Value& value, double least, double most) const;
    std::vector<double> list(const std::string& key, const Value& value, double least, double most) const;

    const Value* value_;
    std::string file_, object_;
    std::vector<std::string> known_;  // keys that were read
};

}  // namespace tessera::display_file
