#include "client/import/gltf_material_check.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <span>

#include "client/import/gltf_extensions.h"

namespace tessera::import {
namespace {

using nlohmann::json;

constexpr std::size_t MostNotices = 64;  // bounds the log of a malformed file

enum class Type { Number, Pair, Color, ColorAndAlpha, WholeNumber, Flag, AlphaMode, Object, Texture };

struct Range {
    double lowest = 0.0, highest = 1.0;
};
constexpr Range Unit{};
constexpr Range FromZero{0.0, 1e12};
constexpr Range Any{-1e6, 1e6};  // beyond, texture coordinates lose all precision
constexpr Range Scale{-1e3, 1e3};
constexpr Range Whole{0.0, 2147483647.0};

// A member by its JSON path. The objects on the path have rules of their own, earlier in the list.
struct Rule {
    std::string path;
    Type type;
    Range range{};
};

const Rule OfMaterials[] = {
    {"pbrMetallicRoughness", Type::Object},
    {"pbrMetallicRoughness/baseColorFactor", Type::ColorAndAlpha, Unit},
    {"pbrMetallicRoughness/baseColorTexture", Type::Texture},
    {"pbrMetallicRoughness/metallicFactor", Type::Number, Unit},
    {"pbrMetallicRoughness/roughnessFactor", Type::Number, Unit},
    {"pbrMetallicRoughness/metallicRoughnessTexture", Type::Texture},
    {"normalTexture", Type::Texture},
    {"occlusionTexture", Type::Texture},
    {"emissiveFactor", Type::Color, FromZero},
    {"emissiveTexture", Type::Texture},
    {"alphaMode", Type::AlphaMode},
    {"alphaCutoff", Type::Number, FromZero},
    {"doubleSided", Type::Flag},
    {"extensions", Type::Object},
    {"extensions/KHR_materials_emissive_strength", Type::Object},
    {"extensions/KHR_materials_emissive_strength/emissiveStrength", Type::Number, FromZero},
    {"extensions/KHR_materials_unlit", Type::Object},
};

const Rule OfTextures[] = {
    {"texCoord", Type::WholeNumber, Whole},
    {"scale", Type::Number, Scale},
    {"strength", Type::Number, Unit},
    {"extensions", Type::Object},
    {"extensions/KHR_texture_transform", Type::Object},
    {"extensions/KHR_texture_transform/offset", Type::Pair, Any},
    {"extensions/KHR_texture_transform/rotation", Type::Number, Any},
    {"extensions/KHR_texture_transform/scale", Type::Pair, Any},
    {"extensions/KHR_texture_transform/texCoord", Type::WholeNumber, Whole},
};

// Rules for the extensions in the table gltf_members().
std::vector<Rule> of_extensions() {
    std::vector<Rule> rules;
    std::string_view open;
    for (const GltfMember& member : gltf_members()) {
        const std::string extension = std::string("extensions/") + member.extension;
        if (open != member.extension) rules.push_back({extension, Type::Object});
        open = member.extension;
        constexpr Type Types[] = {Type::Number, Type::Color, Type::Texture};  // as in GltfMember::field
        rules.push_back(
            {extension + "/" + member.name, Types[member.field.index()], {member.least, member.most}});
    }
    return rules;
}

bool is_whole(const json& value) {
    return value.is_number_integer() && value >= 0 && value <= Whole.highest;
}

std::string out_of_range(Range range) {
    char text[64];
    std::snprintf(text, sizeof text, "outside %g to %g", range.lowest, range.highest);
    return text;
}

std::string check_numbers(const json& value, std::size_t count, Range range) {
    if (!value.is_array() || value.size() != count) return "not " + std::to_string(count) + " numbers";
    for (const json& number : value) {
        if (!number.is_number()) return "not " + std::to_string(count) + " numbers";
        const double it = number;
        if (!(it >= range.lowest && it <= range.highest)) return out_of_range(range);
    }
    return "";
}

// Why a value is rejected; "" = it is valid.
std::string cause_of_rejection(const json& value, const Rule& rule) {
    switch (rule.type) {
        case Type::Number:
            if (!value.is_number()) return "not a number";
            // KHR_materials_ior: 0 is a surface that reflects everything.
            if (rule.path == "extensions/KHR_materials_ior/ior" && value == 0.0) return "";
            return check_numbers(json::array({value}), 1, rule.range);
        case Type::Pair:
            return check_numbers(value, 2, rule.range);
        case Type::Color:
            return check_numbers(value, 3, rule.range);
        case Type::ColorAndAlpha:
            return check_numbers(value, 4, rule.range);
        case Type::WholeNumber:
            return is_whole(value) ? "" : "not a non-negative integer";
        case Type::Flag:
            return value.is_boolean() ? "" : "neither true nor false";
        case Type::AlphaMode:
            return value == "OPAQUE" || value == "MASK" || value == "BLEND"
                       ? ""
                       : "none of OPAQUE, MASK and BLEND";
        case Type::Object:
            return value.is_object() ? "" : "not an object";
        case Type::Texture:
            return value.is_object() && value.contains("index") && is_whole(value["index"])
                       ? ""
                       : "not an object with an integer index";
    }
    return "";
}

class Check {
  public:
    explicit Check(json& materials) : materials_(materials) {}

    bool changed() const { return changed_; }

    std::vector<std::string> run() {
        for (std::size_t i = 0; i < materials_.size(); ++i) {
            json& material = materials_[i];
            name_ = "material " + std::to_string(i);
            if (!material.is_object()) {
                reject_value("", material, "not an object");
                material = json::object();
                continue;
            }
            if (const auto name = material.find("name");
                name != material.end() && name->is_string() && !name->get_ref<const std::string&>().empty())
                name_ = "material '" + name->get<std::string>().substr(0, 100) + "'";
            check(material, OfMaterials, "");
            check(material, extensions_, "");
            check_emissive_factor(material);
        }
        if (others_ > 0) notices_.push_back(std::to_string(others_) + " other wrong values of materials");
        return std::move(notices_);
    }

  private:
    void check(json& object, std::span<const Rule> rules, const std::string& owner) {
        for (const Rule& rule : rules) {
            const json::json_pointer pointer("/" + rule.path);
            if (!object.contains(pointer)) continue;
            json& value = object[pointer];
            const std::string path = owner + rule.path;
            round(value, rule.range);
            if (const std::string cause = cause_of_rejection(value, rule); !cause.empty()) {
                reject_value(path, value, cause);
                object[pointer.parent_pointer()].erase(pointer.back());
            } else if (rule.type == Type::Texture) {
                check(value, OfTextures, path + "/");
            }
        }
    }

    // Values just outside the range are rounding errors of exporters that write single precision.
    void round(json& value, Range range) {
        if (value.is_array()) {
            for (json& number : value) round(number, range);
        } else if (value.is_number_float()) {
            const double it = value, near = std::clamp(it, range.lowest, range.highest);
            if (it == near || !(std::abs(it - near) < 1e-6)) return;
            value = near;
            changed_ = true;
        }
    }

    void check_emissive_factor(const json& material) {
        const auto factor = material.find("emissiveFactor");
        if (factor == material.end()) return;
        for (const json& number : *factor) {
            if (number <= 1.0) continue;
            return add("emissiveFactor is " + shown(*factor) +
                       ", above 1: it is used unchanged; export it as KHR_materials_emissive_strength");
        }
    }

    void reject_value(const std::string& field, const json& value, const std::string& cause) {
        changed_ = true;
        add((field.empty() ? "it" : field) + " is " + shown(value) + ", " + cause +
            ": its default is used, correct it");
    }

    void add(const std::string& what) {
        if (notices_.size() < MostNotices) {
            notices_.push_back(name_ + ": " + what);
        } else {
            ++others_;
        }
    }

    static std::string shown(const json& value) {
        const std::string text = value.dump(-1, ' ', true, json::error_handler_t::replace);
        return text.size() <= 60 ? text : text.substr(0, 57) + "...";
    }

    json& materials_;
    const std::vector<Rule> extensions_ = of_extensions();
    std::string name_;
    std::vector<std::string> notices_;
    std::size_t others_ = 0;
    bool changed_ = false;
};

}  // namespace

CheckedMaterials check_gltf_materials(std::string_view text) {
    json materials = json::parse(text, nullptr, false);
    if (materials.is_discarded() || !materials.is_array()) return {};
    CheckedMaterials checked;
    Check check(materials);
    checked.notices = check.run();
    if (check.changed()) checked.json = materials.dump(-1, ' ', false, json::error_handler_t::replace);
    return checked;
}

}  // namespace tessera::import
