#pragma once

#include "mediator/net/channel.h"
#include "mediator/wire/messages.h"

namespace tessera::master {

// May a peer whose key has this role send this kind of message?
bool allowed(net::Role role, const wire::ControlMessage& message);
bool allowed(net::Role role, const wire::BulkMessage& message);

}  // namespace tessera::master
