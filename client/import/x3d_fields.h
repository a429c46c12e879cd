#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <initializer_list>
#include <pugixml.hpp>
#include <string>
#include <vector>

#include "client/import/x3d_diagnostics.h"

namespace tessera::import {

struct X3dRange {
    double lowest = -1e18, highest = 1e18;
};
inline constexpr X3dRange UpToOne{0.0, 1.0};
inline constexpr X3dRange NotNegative{0.0, 1e12};
inline constexpr X3dRange Positive{1e-18, 1e18};

// The label of a node in messages: "<Box>", "<Material DEF='gold'>".
std::string x3d_label(pugi::xml_node node);

// Fields of one node. Numbers must be finite and separated by white space and commas. A single value that is
// invalid or out of range is reported and replaced by its default; an invalid array throws
// Error{InvalidInput} without naming the node.
class X3dFields {
  public:
    X3dFields(pugi::xml_node node, X3dDiagnostics& diagnostics) : node_(node), diagnostics_(diagnostics) {}

    bool has(const char* field) const { return static_cast<bool>(node_.attribute(field)); }
    bool flag(const char* field, bool otherwise) const;
    std::string word(const char* field, const char* otherwise) const;
    double number(const char* field, double otherwise, X3dRange range = {}) const;
    std::int32_t whole_number(const char* field, std::int32_t otherwise, X3dRange range) const;
    template <class Vector>
    Vector vector(const char* field, const Vector& otherwise, X3dRange range = {}) const {
        Vector result = otherwise;
        const std::vector<double> found = read_numbers(field, {Vector::length()}, range);
        for (std::size_t i = 0; i < found.size(); ++i)
            result[static_cast<glm::length_t>(i)] = static_cast<typename Vector::value_type>(found[i]);
        return result;
    }
    // One number for all components, or one for each.
    template <class Vector>
    Vector number_or_vector(const char* field, const Vector& otherwise, X3dRange range) const {
        const std::vector<double> found = read_numbers(field, {1, Vector::length()}, range);
        Vector result = otherwise;
        for (glm::length_t i = 0; i < Vector::length() && !found.empty(); ++i)
            result[i] = static_cast<typename Vector::value_type>(
                found[found.size() == 1 ? 0 : static_cast<std::size_t>(i)]);
        return result;
    }

    std::vector<std::int32_t> whole_numbers(const char* field) const;
    std::vector<float> numbers(const char* field) const;
    template <class Vector>
    std::vector<Vector> vectors(const char* field) const {
        const std::vector<float> all = numbers(field);
        constexpr auto Size = static_cast<std::size_t>(Vector::length());
        if (all.size() % Size != 0) reject_count(field, all.size(), Size);
        std::vector<Vector> result(all.size() / Size);
        for (std::size_t i = 0; i < all.size(); ++i)
            result[i / Size][static_cast<glm::length_t>(i % Size)] = all[i];
        return result;
    }
    std::vector<std::string> strings(const char* field) const;  // each quoted, or a single one without quotes

    // Reports a problem of this node: "<Box> size ...".
    void report(const std::string& what) const;

  private:
    // The count of numbers must be one of `counts`; returns none if the field is absent or invalid.
    std::vector<double> read_numbers(const char* field, std::initializer_list<int> counts,
                                     X3dRange range) const;
    [[noreturn]] void reject_count(const char* field, std::size_t count, std::size_t size) const;

    pugi::xml_node node_;
    X3dDiagnostics& diagnostics_;
};

}  // namespace tessera::import
