#include "mediator/net/keys.h"

#include <zmq.h>

#include <algorithm>
#include <array>

#include "mediator/net/key_file.h"
#include "mediator/net/secret_file.h"

namespace tessera::net {

namespace {

constexpr const char* Master = "master";
constexpr std::array Roles{Role::Viewer, Role::Editor, Role::Node, Role::Operator};

std::string key_in(const std::filesystem::path& file) {
    return parse_key(file, read_text(file));
}

}  // namespace

KeyPair make_key_pair() {
    std::array<char, 41> public_key{}, secret_key{};
    if (zmq_curve_keypair(public_key.data(), secret_key.data()) != 0) {
        throw Error(ErrorCode::Internal, "libzmq cannot make CURVE keys: it was built without libsodium");
    }
    return {public_key.data(), secret_key.data()};
}

void KeyDirectory::store(const std::string& name, const KeyPair& pair) const {
    write_text(folder_ / (name + ".public"), pair.public_key + "\n", Visibility::Everyone);
    write_text(folder_ / (name + ".secret"), pair.secret_key + "\n", Visibility::Owner);
}

KeyPair KeyDirectory::load(const std::string& name) const {
    const auto secret = folder_ / (name + ".secret");
    require_private(secret);
    KeyPair pair{key_in(folder_ / (name + ".public")), key_in(secret)};
    require_pair(secret, pair);
    return pair;
}

void KeyDirectory::create() const {
    if (std::filesystem::exists(folder_ / "master.secret")) {
        throw Error(ErrorCode::Refused,
                    "'" + folder_.string() +
                        "' holds a master key already: choose another folder or remove it first");
    }
    std::error_code error;
    const bool is_new = std::filesystem::create_directories(folder_, error);
    if (error) {
        throw Error(ErrorCode::Io, "cannot create folder '" + folder_.string() + "': " + error.message());
    }
    if (is_new) std::filesystem::permissions(folder_, std::filesystem::perms::owner_all);
    std::vector<AllowedKey> keys;
    for (const Role role : Roles) {
        const KeyPair pair = make_key_pair();
        store(net::name(role), pair);
        keys.push_back({net::name(role), role, pair.public_key});
    }
    write_allowed(keys);
    store(Master, make_key_pair());  // last: its presence marks a complete folder
}

std::vector<AllowedKey> KeyDirectory::allowed() const {
    const auto file = folder_ / "allowed.keys";
    require_unwritable(file);
    return parse_allowed(file, read_text(file));
}

void KeyDirectory::write_allowed(const std::vector<AllowedKey>& keys) const {
    write_text(folder_ / "allowed.keys", allowed_text(keys), Visibility::Owner);
}

void KeyDirectory::add(const std::string& name, Role role, const std::filesystem::path& export_file) const {
    if (!is_key_name(name) || name == Master) {
        throw Error(ErrorCode::InvalidInput,
                    "'" + name + "' is not a valid name: use letters, digits, '-' and '_', but not 'master'");
    }
    if (role == Role::None) {
        throw Error(ErrorCode::InvalidInput, "a key needs a role: viewer, editor, node or operator");
    }
    std::vector<AllowedKey> keys = allowed();
    for (const AllowedKey& key : keys) {
        if (key.name == name) {
            throw Error(ErrorCode::Refused, "'" + name + "' exists already: revoke it first");
        }
    }
    if (std::filesystem::exists(export_file)) {
        throw Error(ErrorCode::Refused, "'" + export_file.string() + "' exists already: choose another file");
    }
    const KeyPair pair = make_key_pair();
    const KeyExport exported{.name = name, .role = role, .keys = {pair, key_in(folder_ / "master.public")}};
    write_text(export_file, export_text(exported), Visibility::Owner);
    keys.push_back({name, role, pair.public_key});
    try {
        write_allowed(keys);
    } catch (const Error&) {
        std::error_code ignored;
        std::filesystem::remove(export_file, ignored);  // a key that is not on the list is useless
        throw;
    }
}

void KeyDirectory::revoke(const std::string& name) const {
    std::vector<AllowedKey> keys = allowed();
    if (std::erase_if(keys, [&](const AllowedKey& key) { return key.name == name; }) == 0) {
        throw Error(ErrorCode::NotFound, "no key is called '" + name + "': see 'tessera keys DIR list'");
    }
    write_allowed(keys);
    for (const char* ending : {".secret", ".public"}) {
        std::error_code ignored;  // most have no local pair
        std::filesystem::remove(folder_ / (name + ending), ignored);
    }
}

KeyPair KeyDirectory::master() const {
    return load(Master);
}

ClientKeys KeyDirectory::client(const std::string& name) const {
    if (std::filesystem::is_regular_file(folder_)) {
        require_private(folder_);
        return parse_export(folder_, read_text(folder_)).keys;
    }
    if (!is_key_name(name)) {
        throw Error(ErrorCode::InvalidInput,
                    "'" + name + "' is not the name of a key: see 'tessera keys DIR list'");
    }
    return {load(name), key_in(folder_ / "master.public")};
}

}  // namespace tessera::net
