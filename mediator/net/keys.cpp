#include "mediator/net/keys.h"

#include <zmq.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <sstream>

#include "mediator/net/secret_file.h"

namespace tessera::net {

namespace {

constexpr std::size_t Z85Length = 40;
constexpr const char* Master = "master";
constexpr const char* ExportHeader = "tessera-keys 1";

bool is_name(const std::string& name) {
    return !name.empty() && name.size() <= 64 && std::all_of(name.begin(), name.end(), [](unsigned char c) {
        return std::isalnum(c) != 0 || c == '-' || c == '_';
    });
}

Role role_by_name(const std::string& text) {
    for (const Role role : {Role::Viewer, Role::Editor, Role::Node, Role::Operator}) {
        if (text == name(role)) return role;
    }
    return Role::None;
}

std::string key_in(const std::filesystem::path& path, std::string text) {
    while (!text.empty() && std::isspace(static_cast<unsigned char>(text.back())) != 0) text.pop_back();
    std::array<std::uint8_t, 32> binary{};
    if (text.size() != Z85Length || zmq_z85_decode(binary.data(), text.c_str()) == nullptr) {
        throw Error(ErrorCode::InvalidInput,
                    "'" + path.string() + "' holds no key: make new ones with 'tessera keys'");
    }
    return text;
}

ClientKeys read_export(const std::filesystem::path& file) {
    require_private(file);
    std::istringstream lines(read_text(file));
    std::string header;
    std::getline(lines, header);
    ClientKeys keys;
    for (std::string what, value; lines >> what >> value;) {
        if (what == "public") keys.own.public_key = key_in(file, value);
        if (what == "secret") keys.own.secret_key = key_in(file, value);
        if (what == "master") keys.server_public_key = key_in(file, value);
    }
    if (header != ExportHeader || keys.own.public_key.empty() || keys.own.secret_key.empty() ||
        keys.server_public_key.empty()) {
        throw Error(ErrorCode::InvalidInput,
                    "'" + file.string() +
                        "' is no exported key file: make one with 'tessera keys add NAME --export FILE'");
    }
    return keys;
}

}  // namespace

KeyPair make_key_pair() {
    std::array<char, Z85Length + 1> public_key{}, secret_key{};
    if (zmq_curve_keypair(public_key.data(), secret_key.data()) != 0) {
        throw Error(ErrorCode::Internal, "libzmq cannot make CURVE keys: it was built without libsodium");
    }
    return {public_key.data(), secret_key.data()};
}

void KeyDirectory::store(const std::string& name, const KeyPair& pair) const {
    write_text(folder_ / (name + ".public"), pair.public_key + "\n", Visibility::Everybody);
    write_text(folder_ / (name + ".secret"), pair.secret_key + "\n", Visibility::Owner);
}

KeyPair KeyDirectory::load(const std::string& name) const {
    const auto secret = folder_ / (name + ".secret"), open = folder_ / (name + ".public");
    require_private(secret);
    return {key_in(open, read_text(open)), key_in(secret, read_text(secret))};
}

void KeyDirectory::create() const {
    if (std::filesystem::exists(folder_ / "master.secret")) {
        throw Error(ErrorCode::Refused,
                    "'" + folder_.string() +
                        "' holds a master key already: choose another folder or remove it first");
    }
    std::error_code error;
    std::filesystem::create_directories(folder_, error);
    if (error)
        throw Error(ErrorCode::Io, "cannot make folder '" + folder_.string() + "': " + error.message());
    std::filesystem::permissions(folder_, std::filesystem::perms::owner_all);
    store(Master, make_key_pair());
    std::vector<AllowedKey> keys;
    for (const Role role : {Role::Viewer, Role::Editor, Role::Node, Role::Operator}) {
        const KeyPair pair = make_key_pair();
        store(net::name(role), pair);
        keys.push_back({net::name(role), role, pair.public_key});
    }
    write_allowed(keys);
}

std::vector<AllowedKey> KeyDirectory::allowed() const {
    const auto file = folder_ / "allowed.keys";
    std::istringstream lines(read_text(file));
    std::vector<AllowedKey> keys;
    int number = 0;
    for (std::string line; std::getline(lines, line);) {
        ++number;
        if (line.empty() || line[0] == '#') continue;
        std::istringstream words(line);
        AllowedKey key;
        std::string role, rest;
        words >> key.name >> role >> key.public_key;
        key.role = role_by_name(role);
        const bool twice = std::any_of(keys.begin(), keys.end(), [&](const AllowedKey& other) {
            return other.name == key.name || other.public_key == key.public_key;
        });
        if (!is_name(key.name) || key.role == Role::None || (words >> rest) || twice) {
            throw Error(ErrorCode::InvalidInput,
                        "'" + file.string() + "' line " + std::to_string(number) +
                            ": expected a new name, a role (viewer, editor, node, operator) "
                            "and a new public key");
        }
        key.public_key = key_in(file, key.public_key);
        keys.push_back(std::move(key));
    }
    return keys;
}

void KeyDirectory::write_allowed(const std::vector<AllowedKey>& keys) const {
    std::string text = "# name role public-key; read again on SIGHUP\n";
    for (const AllowedKey& key : keys)
        text += key.name + " " + net::name(key.role) + " " + key.public_key + "\n";
    write_text(folder_ / "allowed.keys", text, Visibility::Owner);
}

void KeyDirectory::add(const std::string& name, Role role, const std::filesystem::path& export_file) const {
    if (!is_name(name) || name == Master) {
        throw Error(ErrorCode::InvalidInput,
                    "'" + name + "' is no good name: use letters, digits, '-' and '_'");
    }
    std::vector<AllowedKey> keys = allowed();
    for (const AllowedKey& key : keys) {
        if (key.name == name)
            throw Error(ErrorCode::Refused, "'" + name + "' is there already: revoke it first");
    }
    const KeyPair pair = make_key_pair();
    const std::string master_key = key_in(folder_ / "master.public", read_text(folder_ / "master.public"));
    write_text(export_file,
               std::string(ExportHeader) + "\nname " + name + "\npublic " + pair.public_key + "\nsecret " +
                   pair.secret_key + "\nmaster " + master_key + "\n",
               Visibility::Owner);
    keys.push_back({name, role, pair.public_key});
    write_allowed(keys);
}

void KeyDirectory::revoke(const std::string& name) const {
    std::vector<AllowedKey> keys = allowed();
    if (std::erase_if(keys, [&](const AllowedKey& key) { return key.name == name; }) == 0) {
        throw Error(ErrorCode::NotFound, "no key is called '" + name + "': see 'tessera keys list'");
    }
    write_allowed(keys);
}

KeyPair KeyDirectory::master() const {
    return load(Master);
}

ClientKeys KeyDirectory::client(const std::string& name) const {
    if (std::filesystem::is_regular_file(folder_)) return read_export(folder_);
    const auto master_key = folder_ / "master.public";
    return {load(name), key_in(master_key, read_text(master_key))};
}

}  // namespace tessera::net
