#include "mediator/net/zmq_info.h"

#include <zmq.h>

namespace tessera::net {

ZmqInfo zmq_info() {
    int major = 0, minor = 0, patch = 0;
    ::zmq_version(&major, &minor, &patch);
    return {std::to_string(major) + "." + std::to_string(minor) + "." + std::to_string(patch),
            ::zmq_has("curve") == 1};
}

}  // namespace tessera::net
