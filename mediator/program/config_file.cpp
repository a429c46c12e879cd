#include <toml++/toml.h>

#include <filesystem>
#include <sstream>

#include "mediator/base/error.h"
#include "mediator/program/command_line.h"

namespace tessera::cli {

namespace {

std::string text(const toml::node& node, const std::string& path) {
    if (const auto* string = node.as_string()) return string->get();
    std::ostringstream out;
    out.precision(17);
    if (const auto* integer = node.as_integer()) {
        out << integer->get();
    } else if (const auto* number = node.as_floating_point()) {
        out << number->get();
    } else {
        throw Error(ErrorCode::InvalidInput, "a value in '" + path + "' at line " +
                                                 std::to_string(node.source().begin.line) +
                                                 " is not text, a number, yes/no or a list of these");
    }
    return out.str();
}

void add(const toml::table& table, const std::string& command, const std::string& path,
         std::vector<ConfigSection>& sections) {
    const std::size_t own = sections.size();
    sections.push_back({command, {}});
    for (const auto& [key, node] : table) {
        const std::string name(key.str());
        if (const auto* inner = node.as_table()) {
            add(*inner, command.empty() ? name : command + " " + name, path, sections);
            continue;
        }
        std::vector<std::string>& words = sections[own].words;
        if (const auto* boolean = node.as_boolean()) {
            if (boolean->get()) words.push_back("--" + name);
        } else if (const auto* array = node.as_array()) {
            for (const toml::node& element : *array) words.push_back("--" + name + "=" + text(element, path));
        } else {
            words.push_back("--" + name + "=" + text(node, path));
        }
    }
}

}  // namespace

std::vector<ConfigSection> read_config(const std::string& path) {
    if (!std::filesystem::is_regular_file(path)) {
        throw Error(ErrorCode::NotFound, "no configuration file '" + path + "'; check --config");
    }
    try {
        const toml::table table = toml::parse_file(path);
        std::vector<ConfigSection> sections;
        add(table, "", path, sections);
        return sections;
    } catch (const toml::parse_error& error) {
        throw Error(ErrorCode::InvalidInput, "'" + path + "' line " +
                                                 std::to_string(error.source().begin.line) +
                                                 " is not valid TOML: " + std::string(error.description()));
    }
}

}  // namespace tessera::cli
