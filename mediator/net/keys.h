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

// What a client needs: its own pair and the master's public key.
struct ClientKeys {
    KeyPair own;
    std::string server_public_key;
};

// A folder: master.public, master.secret (0600), allowed.keys (a line per key: name, role, public key), and
// per local name NAME.public, NAME.secret (0600). Or one file that add() exported for another machine: of it
// only client() is possible. Every read throws Error: Refused for a secret that others may read, with the
// chmod that helps, NotFound and InvalidInput with the file's name.
class KeyDirectory {
  public:
    explicit KeyDirectory(std::filesystem::path folder) : folder_(std::move(folder)) {}

    // Master pair and one pair per role; throws Error{Refused} when a master pair is there already.
    void create() const;
    // A new key for another machine: `export_file` (0600, must not exist) gets its pair and the master's
    // public key, the folder only its public key. Throws Error{Refused} for a name that is there already.
    void add(const std::string& name, Role role, const std::filesystem::path& export_file) const;
    // Takes it off the list, and its local pair away. A running master has to read the list again.
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
