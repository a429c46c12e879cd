#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "mediator/base/error.h"
#include "mediator/net/channel.h"

namespace tessera::net {

// A CURVE key pair, Z85 text of 40 characters each.
struct KeyPair {
    std::string public_key, secret_key;
};
KeyPair make_key_pair();

struct AllowedKey {
    std::string name;  // unique
    Role role = Role::None;
    std::string public_key;
};

// The keys of a client: its own pair and the master's public key.
struct ClientKeys {
    KeyPair own;
    std::string server_public_key;
};

// A folder: master.public, master.secret (0600), allowed.keys (a line per key: name, role, public key), and
// per local name NAME.public, NAME.secret (0600). Or a single file exported by add() for another machine, which supports
// only client(). Every read throws Error: Refused for a secret that others may read, with the chmod command that fixes
// it; NotFound and InvalidInput with the file's name.
class KeyDirectory {
  public:
    explicit KeyDirectory(std::filesystem::path folder) : folder_(std::move(folder)) {}

    // Creates the master's pair and one pair per role; throws Error{Refused} if a master pair exists.
    void create() const;
    // Creates a key for another machine: its pair and the master's public key are written to `export_file` (0600, must
    // not exist), only its public key to the folder. Throws Error{Refused} for an existing name.
    void add(const std::string& name, Role role, const std::filesystem::path& export_file) const;
    // Removes it from the list, and its local pair. A running master has to reload the list.
    void revoke(const std::string& name) const;
    std::vector<AllowedKey> allowed() const;
    KeyPair master() const;
    // NAME's pair with the master's public key; an exported file has one name only, whatever is asked for.
    ClientKeys client(const std::string& name) const;
    const std::filesystem::path& folder() const { return folder_; }

  private:
    void store(const std::string& name, const KeyPair& pair) const;
    KeyPair load(const std::string& name) const;
    void write_allowed(const std::vector<AllowedKey>& keys) const;

    std::filesystem::path folder_;
};

}  // namespace tessera::net
