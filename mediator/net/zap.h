#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <vector>
#include <zmq.hpp>

#include "mediator/net/keys.h"

namespace tessera::net {

// Answers libzmq's question whether a CURVE key may connect (RFC 27), for all servers of one context, each a
// domain of its own. Runs on a thread; must run before the first bind, since libzmq accepts every key without a
// handler.
class ZapHandler {
  public:
    explicit ZapHandler(zmq::context_t& context);
    ~ZapHandler();

    // Sets or replaces the allow-list of a domain. Thread-safe.
    void allow(const std::string& domain, const std::vector<AllowedKey>& keys);
    void forget(const std::string& domain);
    // Is this User-Id still on the list? Thread-safe.
    bool is_allowed(const std::string& domain, const std::string& user_id) const;
    std::uint64_t refused(const std::string& domain) const;

  private:
    void run();
    void answer(const std::vector<zmq::message_t>& request);
    // The User-Id of a key; nothing (and counted as refused) if it is not on the domain's list.
    std::optional<std::string> admit(const std::string& domain, const std::string& public_key);

    zmq::socket_t socket_, stop_sender_, stop_receiver_;

    mutable std::mutex mutex_;  // protects the members below
    struct Domain {
        std::map<std::string, std::string> user_id_by_key;
        std::set<std::string> user_ids;
        std::uint64_t refused = 0;
    };
    std::map<std::string, Domain> domains_;

    std::thread thread_;
};

// "role:name:KEY", so that a name given to another key is another user. Parsed where messages come in.
struct User {
    Role role = Role::None;
    std::string name;
};
std::string user_id(const AllowedKey& key);
User user_of(const std::string& user_id);

}  // namespace tessera::net
