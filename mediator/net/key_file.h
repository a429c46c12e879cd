#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "mediator/net/keys.h"

// The texts in which keys lie on disk. All throw Error{InvalidInput} that names the file for what they cannot
// read.
namespace tessera::net {

bool is_key_name(const std::string& name);  // 1 to 64 letters, digits, '-' and '_'

// A Z85 key with white space around it.
std::string parse_key(const std::filesystem::path& source, std::string text);

// Throws when the public key is not that of the secret one.
void require_pair(const std::filesystem::path& source, const KeyPair& pair);

// allowed.keys: a line "name role public-key" for each; names and keys are unique. '#' begins a comment line.
std::vector<AllowedKey> parse_allowed(const std::filesystem::path& source, const std::string& text);
std::string allowed_text(const std::vector<AllowedKey>& keys);

// The one file that another machine needs, in TOML: name, role, public, secret, master.
struct KeyExport {
    std::string name;
    Role role = Role::None;
    ClientKeys keys;
};
KeyExport parse_export(const std::filesystem::path& source, const std::string& text);
std::string export_text(const KeyExport& exported);

}  // namespace tessera::net
