#pragma once

#include <functional>
#include <memory>

#include "client/session.h"
#include "mediator/net/channel.h"

namespace tessera::client {

// A session over a channel of any kind, of which it is the client end; `reconnect` makes new sockets behind it,
// may be empty, and is called on the session's thread. `blobs` holds whatever edits refer to.
std::unique_ptr<Session> make_session(std::unique_ptr<net::Channel> channel, std::function<void()> reconnect,
                                      std::shared_ptr<scene::BlobStore> blobs, const Clock& clock,
                                      SessionSettings settings);

}  // namespace tessera::client
