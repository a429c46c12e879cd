#include "mediator/net/key_file.h"

#include <zmq.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <map>
#include <sstream>

namespace tessera::net {

namespace {

constexpr std::size_t Z85Length = 40;

bool is_space(char c) {
    return std::isspace(static_cast<unsigned char>(c)) != 0;
}

std::string trimmed(std::string text) {
    while (!text.empty() && is_space(text.back())) text.pop_back();
    text.erase(text.begin(), std::find_if_not(text.begin(), text.end(), is_space));
    return text;
}

[[noreturn]] void no_export(const std::filesystem::path& source, const std::string& why) {
    throw Error(ErrorCode::InvalidInput, "'" + source.string() + "' is no exported key file (" + why +
                                             "): make one with 'tessera keys DIR add NAME --export FILE'");
}

// The part of TOML that an export needs: name = "text", without escapes, which no key contains.
std::map<std::string, std::string> parse_strings(const std::filesystem::path& source,
                                                 const std::string& text) {
    std::map<std::string, std::string> values;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
        line = trimmed(line);
        if (line.empty() || line[0] == '#') continue;
        const std::size_t equals = line.find('=');
        if (equals == std::string::npos) no_export(source, "a line without '='");
        const std::string value = trimmed(line.substr(equals + 1));
        if (value.size() < 2 || value.front() != '"' || value.back() != '"') {
            no_export(source, "a value without quotes");
        }
        if (!values.emplace(trimmed(line.substr(0, equals)), value.substr(1, value.size() - 2)).second) {
            no_export(source, "a name twice");
        }
    }
    return values;
}

}  // namespace

bool is_key_name(const std::string& name) {
    return !name.empty() && name.size() <= 64 && std::all_of(name.begin(), name.end(), [](unsigned char c) {
        return std::isalnum(c) != 0 || c == '-' || c == '_';
    });
}

std::string parse_key(const std::filesystem::path& source, std::string text) {
    text = trimmed(std::move(text));
    std::array<std::uint8_t, 32> binary{};
    if (text.size() != Z85Length || zmq_z85_decode(binary.data(), text.c_str()) == nullptr) {
        throw Error(ErrorCode::InvalidInput,
                    "'" + source.string() + "' contains no key: create new ones with 'tessera keys DIR'");
    }
    return text;
}

void require_pair(const std::filesystem::path& source, const KeyPair& pair) {
    std::array<char, Z85Length + 1> derived{};
    if (zmq_curve_public(derived.data(), pair.secret_key.c_str()) != 0 || pair.public_key != derived.data()) {
        throw Error(ErrorCode::InvalidInput, "the secret key in '" + source.string() +
                                                 "' does not belong to its public key: copy both again");
    }
}

std::vector<AllowedKey> parse_allowed(const std::filesystem::path& source, const std::string& text) {
    std::istringstream lines(text);
    std::vector<AllowedKey> keys;
    int number = 0;
    for (std::string line; std::getline(lines, line);) {
        ++number;
        if (trimmed(line).empty() || line[0] == '#') continue;
        std::istringstream words(line);
        AllowedKey key;
        std::string role, rest;
        words >> key.name >> role >> key.public_key;
        key.role = role_named(role);
        const bool twice = std::any_of(keys.begin(), keys.end(), [&](const AllowedKey& other) {
            return other.name == key.name || other.public_key == key.public_key;
        });
        if (!is_key_name(key.name) || key.role == Role::None || (words >> rest) || twice) {
            throw Error(ErrorCode::InvalidInput,
                        "'" + source.string() + "' line " + std::to_string(number) +
                            ": expected a unique name, a role (viewer, editor, node, operator) "
                            "and a unique public key");
        }
        key.public_key = parse_key(source, key.public_key);
        keys.push_back(std::move(key));
    }
    return keys;
}

std::string allowed_text(const std::vector<AllowedKey>& keys) {
    std::string text = "# name role public-key; read again on SIGHUP\n";
    for (const AllowedKey& key : keys) {
        text += key.name + " " + name(key.role) + " " + key.public_key + "\n";
    }
    return text;
}

KeyExport parse_export(const std::filesystem::path& source, const std::string& text) {
    auto values = parse_strings(source, text);
    for (const char* needed : {"name", "role", "public", "secret", "master"}) {
        if (!values.contains(needed)) no_export(source, std::string("without '") + needed + "'");
    }
    KeyExport exported{
        .name = values["name"],
        .role = role_named(values["role"]),
        .keys = {.own = {parse_key(source, values["public"]), parse_key(source, values["secret"])},
                 .server_public_key = parse_key(source, values["master"])}};
    if (!is_key_name(exported.name) || exported.role == Role::None) no_export(source, "a bad name or role");
    require_pair(source, exported.keys.own);
    return exported;
}

std::string export_text(const KeyExport& exported) {
    const auto line = [](const char* what, const std::string& value) {
        return std::string(what) + " = \"" + value + "\"\n";
    };
    return "# Tessera: one machine's own key. Keep it secret.\n" + line("name", exported.name) +
           line("role", name(exported.role)) + line("public", exported.keys.own.public_key) +
           line("secret", exported.keys.own.secret_key) + line("master", exported.keys.server_public_key);
}

}  // namespace tessera::net
