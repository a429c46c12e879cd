#pragma once

#include <string>

namespace tessera::net {

// Version and capabilities of the loaded ZeroMQ library.
struct ZmqInfo {
    std::string version;  // "4.3.4"
    bool has_curve = false;
};
ZmqInfo zmq_info();

}  // namespace tessera::net
