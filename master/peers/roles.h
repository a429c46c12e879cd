#pragma once

#include <string>

#include "mediator/net/channel.h"
#include "mediator/wire/messages.h"

namespace tessera::master {

// May a peer whose key has this role send this kind of message?
bool allowed(net::Role role, const wire::ControlMessage& message);
bool allowed(net::Role role, const wire::BulkMessage& message);

// All messages that a peer may send to a master, and which roles may: a table in Markdown, for docs/security.md.
std::string role_table();

}  // namespace tessera::master
