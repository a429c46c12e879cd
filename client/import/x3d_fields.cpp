#include "client/import/x3d_fields.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string_view>

#include "client/import/limits.h"
#include "mediator/base/error.h"

namespace tessera::import {
namespace {

constexpr double MaxMagnitude = 1e18;  // its square still fits a float

bool separates(char c) {
    return c == ' ' || c == ',' || c == '\n' || c == '\t' || c == '\r';
}

std::string shown(std::string_view text) {
    return "'" + std::string(text.substr(0, 40)) + "'";
}

// Calls `take` with each number in the text.
template <class Number, class Take>
void each_number(std::string_view text, const Take& take) {
    std::uint64_t count = 0;
    for (std::size_t at = 0; at < text.size();) {
        if (separates(text[at])) {
            ++at;
            continue;
        }
        std::size_t end = at;
        while (end < text.size() && !separates(text[end])) ++end;
        const std::string_view word = text.substr(at, end - at);
        const std::size_t sign = word.starts_with('+') && !word.starts_with("+-") ? 1 : 0;
        Number number{};
        const auto [last, error] = std::from_chars(word.data() + sign, word.data() + word.size(), number);
        if (error != std::errc{} || last != word.data() + word.size() ||
            !(std::abs(static_cast<double>(number)) <= MaxMagnitude)) {
            throw Error(ErrorCode::InvalidInput, shown(word) + " is not a valid number");
        }
        if (++count > MaxElements) throw Error(ErrorCode::InvalidInput, "there are more than 2^28 numbers");
        take(number);
        at = end;
    }
}

std::string describe(X3dRange range) {
    const auto number = [](double value) {
        std::string text = std::to_string(value);
        text.erase(text.find_last_not_of('0') + 1);
        if (text.ends_with('.')) text.pop_back();
        return text;
    };
    if (range.highest >= NotNegative.highest)
        return range.lowest > 0.0 ? "not greater than 0" : "negative or beyond 1e12";
    return "outside " + number(range.lowest) + " to " + number(range.highest);
}

}  // namespace

std::string x3d_label(pugi::xml_node node) {
    const std::string name = node.attribute("DEF").value();
    return std::string("<") + node.name() + (name.empty() ? "" : " DEF=" + shown(name)) + ">";
}

void X3dFields::report(const std::string& what) const {
    diagnostics_.add(x3d_label(node_) + " " + what, node_.offset_debug());
}

bool X3dFields::flag(const char* field, bool otherwise) const {
    if (!has(field)) return otherwise;
    const std::string_view text = node_.attribute(field).value();
    if (text == "true" || text == "TRUE") return true;
    if (text == "false" || text == "FALSE") return false;
    report(std::string(field) + " is " + shown(text) +
           ", neither true nor false: its default is used, correct it");
    return otherwise;
}

std::string X3dFields::word(const char* field, const char* otherwise) const {
    if (!has(field)) return otherwise;
    std::string_view text = node_.attribute(field).value();
    while (!text.empty() && (text.front() == '"' || separates(text.front()))) text.remove_prefix(1);
    while (!text.empty() && (text.back() == '"' || separates(text.back()))) text.remove_suffix(1);
    return std::string(text);
}

std::vector<double> X3dFields::read_numbers(const char* field, std::initializer_list<int> counts,
                                            X3dRange range) const {
    if (!has(field)) return {};
    const std::string_view text = node_.attribute(field).value();
    const int most = std::max(counts);
    std::vector<double> found;
    std::string cause;
    try {
        each_number<double>(text, [&](double value) {
            if (found.size() > static_cast<std::size_t>(most)) return;
            if (!(value >= range.lowest && value <= range.highest)) cause = describe(range);
            found.push_back(value);
        });
    } catch (const Error& error) {
        cause = error.what();
    }
    const int count = static_cast<int>(found.size());
    if (cause.empty() && std::find(counts.begin(), counts.end(), count) == counts.end()) {
        cause = "not " + std::to_string(most) + (most == 1 ? " number" : " numbers");
    }
    if (cause.empty()) return found;
    report(std::string(field) + " is " + shown(text) + ", " + cause + ": its default is used, correct it");
    return {};
}

double X3dFields::number(const char* field, double otherwise, X3dRange range) const {
    const std::vector<double> found = read_numbers(field, {1}, range);
    return found.empty() ? otherwise : found.front();
}

std::int32_t X3dFields::whole_number(const char* field, std::int32_t otherwise, X3dRange range) const {
    const double found = number(field, otherwise, range);
    if (found == std::floor(found)) return static_cast<std::int32_t>(found);
    report(std::string(field) + " is not an integer: its default is used, correct it");
    return otherwise;
}

std::vector<std::int32_t> X3dFields::whole_numbers(const char* field) const {
    std::vector<std::int32_t> values;
    try {
        each_number<std::int32_t>(node_.attribute(field).value(),
                                  [&](std::int32_t value) { values.push_back(value); });
    } catch (const Error& error) {
        throw Error(error.code(), std::string(field) + ": " + error.what());
    }
    return values;
}

std::vector<float> X3dFields::numbers(const char* field) const {
    std::vector<float> values;
    try {
        each_number<double>(node_.attribute(field).value(),
                            [&](double value) { values.push_back(static_cast<float>(value)); });
    } catch (const Error& error) {
        throw Error(error.code(), std::string(field) + ": " + error.what());
    }
    return values;
}

void X3dFields::reject_count(const char* field, std::size_t count, std::size_t size) const {
    throw Error(ErrorCode::InvalidInput, std::string(field) + ": " + std::to_string(count) +
                                             " numbers are not a multiple of " + std::to_string(size));
}

std::vector<std::string> X3dFields::strings(const char* field) const {
    const std::string_view text = node_.attribute(field).value();
    if (text.find('"') == text.npos) {
        const std::string one = word(field, "");
        return one.empty() ? std::vector<std::string>{} : std::vector{one};
    }
    std::vector<std::string> all;
    bool in_quotes = false;
    for (std::size_t i = 0; i < text.size(); ++i) {
        if (text[i] == '"') {
            in_quotes = !in_quotes;
            if (in_quotes) all.emplace_back();
        } else if (in_quotes) {
            if (text[i] == '\\' && i + 1 < text.size()) ++i;
            all.back() += text[i];
        }
    }
    return all;
}

}  // namespace tessera::import
