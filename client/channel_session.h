#pragma once

#include <functional>
#include <memory>

#include "client/session.h"
#include "mediator/net/channel.h"

namespace tessera::client {

// A session over any channel, as its client end. `reconnect` (may be empty) replaces the sockets; it is called on the
// session's thread. `blobs` holds the blobs that edits refer to.
std::unique_ptr<Session> make_session(std::unique_ptr<net::Channel> channel, std::function<void()> reconnect,
                                      std::shared_ptr<scene::BlobStore> blobs, const Clock& clock,
                                      SessionSettings settings);

}  // namespace tessera::client
