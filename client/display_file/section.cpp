#include "client/display_file/section.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <glm/geometric.hpp>

#include "mediator/base/nearest.h"
#include "mediator/display/display.h"

namespace tessera::display_file {

namespace {

constexpr double FarthestPlace = 1e7;

std::string shown(double number) {
    char text[32];
    std::snprintf(text, sizeof text, "%.9g", number);
    return text;
}

}  // namespace

Section::Section(const Value& value, std::string file, std::string object)
    : value_(&value), file_(std::move(file)), object_(std::move(object)) {}

const Value* Section::entry(const std::string& key) const {
    for (const auto& [name, value] : value_->table) {
        if (name == key) return &value;
    }
    return nullptr;
}

const Value* Section::take(const std::string& key) {
    if (std::ranges::find(known_, key) == known_.end()) known_.push_back(key);
    return entry(key);
}

const Value* Section::take(const std::string& key, Value::Kind kind) {
    const Value* value = take(key);
    if (value && value->kind != kind) {
        refuse(key, "'" + key + "' is " + std::string(kind_name(value->kind)) + "; it must be " +
                        std::string(kind_name(kind)));
    }
    return value;
}

double Section::checked(const std::string& key, const Value& value, double least, double most) const {
    if (value.kind != Value::Kind::Number) {
        refuse(key, "'" + key + "' holds " + std::string(kind_name(value.kind)) + " instead of a number");
    }
    if (!(value.number >= least && value.number <= most)) {
        refuse(key, "'" + key + "' is " + shown(value.number) + "; it must be from " + shown(least) + " to " +
                        shown(most));
    }
    return value.number;
}

std::vector<double> Section::list(const std::string& key, const Value& value, double least,
                                  double most) const {
    std::vector<double> numbers;
    for (const Value& element : value.list) numbers.push_back(checked(key, element, least, most));
    return numbers;
}

std::optional<std::string> Section::text(const std::string& key) {
    const Value* value = take(key, Value::Kind::Text);
    if (!value) return std::nullopt;
    if (value->text.size() > 1000) refuse(key, "'" + key + "' has more than 1000 characters");
    return value->text;
}

std::optional<double> Section::number(const std::string& key, double least, double most) {
    const Value* value = take(key, Value::Kind::Number);
    if (!value) return std::nullopt;
    return checked(key, *value, least, most);
}

std::optional<std::int64_t> Section::whole(const std::string& key, std::int64_t least, std::int64_t most) {
    const Value* value = take(key, Value::Kind::Number);
    if (!value) return std::nullopt;
    if (!value->is_whole) refuse(key, "'" + key + "' must be a whole number");
    return std::int64_t(checked(key, *value, double(least), double(most)));
}

std::optional<bool> Section::truth(const std::string& key) {
    const Value* value = take(key, Value::Kind::Truth);
    if (!value) return std::nullopt;
    return value->number != 0.0;
}

std::optional<std::vector<double>> Section::numbers(const std::string& key, double least, double most) {
    const Value* value = take(key, Value::Kind::List);
    if (!value) return std::nullopt;
    return list(key, *value, least, most);
}

std::optional<glm::dvec2> Section::pair(const std::string& key, double least, double most) {
    const auto values = numbers(key, least, most);
    if (!values) return std::nullopt;
    if (values->size() != 2) refuse(key, "'" + key + "' must be two numbers: [across, upward]");
    return glm::dvec2((*values)[0], (*values)[1]);
}

std::optional<glm::dvec3> Section::point(const std::string& key) {
    const auto values = numbers(key, -FarthestPlace, FarthestPlace);
    if (!values) return std::nullopt;
    if (values->size() != 3) refuse(key, "'" + key + "' must be three numbers: [x, y, z] in metres");
    return glm::dvec3((*values)[0], (*values)[1], (*values)[2]);
}

std::optional<glm::dvec3> Section::direction(const std::string& key) {
    const auto direction = point(key);
    if (!direction) return std::nullopt;
    const double length = glm::length(*direction);
    if (!(length > 1e-9)) refuse(key, "'" + key + "' has no length: it must be a direction");
    return *direction / length;
}

std::optional<std::array<std::uint32_t, 2>> Section::counts(const std::string& key, std::uint32_t least,
                                                            std::uint32_t most) {
    const Value* value = take(key, Value::Kind::List);
    if (!value) return std::nullopt;
    const std::vector<double> values = list(key, *value, least, most);
    if (values.size() != 2 || !std::ranges::all_of(value->list, &Value::is_whole))
        refuse(key, "'" + key + "' must be two whole numbers: [across, down]");
    return std::array{std::uint32_t(values[0]), std::uint32_t(values[1])};
}

std::optional<std::array<std::uint32_t, 2>> Section::size(const std::string& key) {
    return counts(key, 1, display::MaxEdge);
}

std::optional<std::size_t> Section::choice(const std::string& key, std::span<const std::string_view> words) {
    const auto word = text(key);
    if (!word) return std::nullopt;
    const auto found = std::ranges::find(words, *word);
    if (found != words.end()) return std::size_t(found - words.begin());
    std::string all;
    for (const std::string_view choice : words) all += (all.empty() ? "" : ", ") + std::string(choice);
    const auto meant = nearest(*word, {words.begin(), words.end()});
    refuse(key, "'" + key + "' is '" + *word + "', none of " + all +
                    (meant ? "; did you mean '" + *meant + "'?" : ""));
}

std::optional<Section> Section::section(const std::string& key) {
    const Value* value = take(key, Value::Kind::Table);
    if (!value) return std::nullopt;
    return Section(*value, file_, object_ + ", " + key);
}

std::vector<Section> Section::sections(const std::string& key) {
    const Value* value = take(key);
    std::vector<Section> found;
    if (!value) return found;
    if (value->kind == Value::Kind::Table) return {Section(*value, file_, key)};
    const bool are_tables =
        value->kind == Value::Kind::List &&
        std::ranges::all_of(value->list, [](const Value& v) { return v.kind == Value::Kind::Table; });
    if (!are_tables) refuse(key, "'" + key + "' must be tables: [[" + key + "]]");
    for (const Value& element : value->list)
        found.emplace_back(element, file_, key + " " + std::to_string(found.size() + 1));
    return found;
}

std::optional<Value::Kind> Section::kind(const std::string& key) const {
    const Value* value = entry(key);
    return value ? std::optional(value->kind) : std::nullopt;
}

void Section::knows(std::initializer_list<const char*> keys) {
    known_.insert(known_.end(), keys.begin(), keys.end());
}

void Section::refuse_unknown() const {
    for (const auto& [key, value] : value_->table) {
        if (std::ranges::find(known_, key) != known_.end()) continue;
        const auto meant = nearest(key, known_);
        std::string all;
        for (const std::string& known : known_) all += (all.empty() ? "" : ", ") + known;
        refuse(key, "there is no key '" + key + "'" +
                        (meant ? "; did you mean '" + *meant + "'?" : "; there are " + all));
    }
}

void Section::refuse(const std::string& key, const std::string& why) const {
    const Value* value = entry(key);
    throw error_at(file_, value ? value->position : value_->position,
                   (object_.empty() ? "" : object_ + ": ") + why);
}

void Section::refuse(const std::string& why) const {
    throw error_at(file_, value_->position, (object_.empty() ? "" : object_ + ": ") + why);
}

void Section::require(const std::string& key) const {
    refuse("needs '" + key + "'");
}

}  // namespace tessera::display_file
