#pragma once

#include <string>

namespace tessera::net {

// What the ZeroMQ library that was loaded is able to do.
struct ZmqFacts {
    std::string version;  // "4.3.4"
    bool has_curve = false;
};
ZmqFacts zmq_facts();

}  // namespace tessera::net
