#pragma once

#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "client/edit/values.h"

// Private to values.cpp and value_reader.cpp: one function for each type of field.
namespace tessera::edit {

template <Enumerated E>
std::vector<std::string> enumerator_names() {
    const auto names = enumerators(E{});
    return {names.begin(), names.end()};
}

// The pieces of one value. Throws ScriptError when there are too few, too many or wrong ones.
class ValueReader {
  public:
    ValueReader(const std::vector<Word>& words, std::size_t end_column, std::string form,
                const ReadPath& read_path);

    void read(std::string& value);
    void read(bool& value);
    void read(float& value);
    void read(double& value);
    void read(std::uint32_t& value);
    void read(std::int32_t& value);
    void read(glm::vec2& value);
    void read(glm::vec3& value);
    void read(glm::vec4& value);
    void read(glm::dvec3& value);
    void read(glm::dmat4& value);
    void read(std::vector<glm::dmat4>& value);
    void read(ObjectId& value);
    void read(std::vector<ObjectId>& value);
    void read(scene::TextureSlot& value);
    void read(scene::BlobRef& value);
    void read(std::vector<scene::BlobRef>& value);
    template <class E>
    requires std::is_enum_v<E>
    void read(E& value) { value = static_cast<E>(choice(enumerator_names<E>())); }

    void expect_end() const;

  private:
    const Word& next();
    [[noreturn]] void reject_bytes() const;
    std::size_t left() const { return pieces_.size() - at_; }
    std::size_t choice(const std::vector<std::string>& names);
    float number();
    template <class I>
    void whole_number(I& value);
    template <class V>
    void numbers(V& value, glm::length_t count);
    [[noreturn]] void wrong(const Word& word) const;

    std::vector<Word> whole_, pieces_;  // as given, and cut at commas
    std::size_t at_ = 0, end_column_;
    std::string form_;
    const ReadPath& read_path_;
};

}  // namespace tessera::edit
