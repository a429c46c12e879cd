#include "client/tools/diagnostics.h"

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "mediator/base/old_names.h"

namespace tessera::tools {

namespace {

constexpr std::string_view BytesSuffix = "_bytes";

const char* name(Severity severity) {
    return severity == Severity::Ok ? "ok" : severity == Severity::Warning ? "note" : "bad";
}

// "shared memory 32.0 KiB", "ray query no".
std::string text_of(const Fact& fact) {
    std::string key = fact.key;
    const bool is_bytes = key.ends_with(BytesSuffix);
    if (is_bytes) key.resize(key.size() - BytesSuffix.size());
    std::replace(key.begin(), key.end(), '_', ' ');
    if (const auto* flag = std::get_if<bool>(&fact.value)) return key + (*flag ? " yes" : " no");
    if (const auto* text = std::get_if<std::string>(&fact.value)) return key + " " + *text;
    const std::uint64_t number = std::get<std::uint64_t>(fact.value);
    return key + " " + (is_bytes ? byte_text(number) : std::to_string(number));
}

void print_facts(const std::vector<Fact>& facts) {
    constexpr std::size_t Width = 84;
    std::string line;
    for (const Fact& fact : facts) {
        const std::string text = text_of(fact);
        if (!line.empty() && line.size() + text.size() + 2 > Width) {
            std::printf("      %-18s %s\n", "", line.c_str());
            line.clear();
        }
        line += (line.empty() ? "" : ", ") + text;
    }
    if (!line.empty()) std::printf("      %-18s %s\n", "", line.c_str());
}

}  // namespace

std::string byte_text(std::uint64_t bytes) {
    constexpr const char* Units[] = {"KiB", "MiB", "GiB", "TiB"};
    if (bytes < 1024) return std::to_string(bytes) + " B";
    double value = double(bytes) / 1024;
    std::size_t unit = 0;
    for (; value >= 1024 && unit + 1 < std::size(Units); ++unit) value /= 1024;
    char text[32];
    std::snprintf(text, sizeof text, "%.1f %s", value, Units[unit]);
    return text;
}

void print(const Diagnostics& diagnostics) {
    for (const Diagnostic& diagnostic : diagnostics) {
        std::printf("%-5s %-18s %s\n", name(diagnostic.severity), diagnostic.subject.c_str(),
                    diagnostic.fact.c_str());
        print_facts(diagnostic.facts);
        if (!diagnostic.remedy.empty()) std::printf("      %-18s -> %s\n", "", diagnostic.remedy.c_str());
    }
}

void print_json(const Diagnostics& diagnostics) {
    auto list = nlohmann::ordered_json::array();
    for (const Diagnostic& diagnostic : diagnostics) {
        nlohmann::ordered_json entry{{"subject", diagnostic.subject},
                                     {"severity", name(diagnostic.severity)},
                                     {std::string(*old_name("key", "severity")), name(diagnostic.severity)},
                                     {"fact", diagnostic.fact},
                                     {"remedy", diagnostic.remedy}};
        for (const Fact& fact : diagnostic.facts) {
            std::visit([&](const auto& value) { entry["facts"][fact.key] = value; }, fact.value);
        }
        list.push_back(std::move(entry));
    }
    std::printf("%s\n", list.dump(2).c_str());
}

}  // namespace tessera::tools
