#include "master/peers/roles.h"

namespace tessera::master {

namespace {

bool is_among(net::Role role, wire::Senders senders) {
    using enum net::Role;
    const bool editor = role == Editor || role == Operator;
    const bool node = role == Node || role == Operator;
    switch (senders) {
        case wire::Senders::Master:
            return false;
        case wire::Senders::Nodes:
            return node;
        case wire::Senders::Editors:
            return editor;
        case wire::Senders::Operators:
            return role == Operator;
        case wire::Senders::Clients:
            return editor || role == Viewer;
        case wire::Senders::Everyone:
            return editor || node || role == Viewer;
    }
    return false;
}

}  // namespace

bool allowed(net::Role role, const wire::ControlMessage& message) {
    if (const auto* hello = std::get_if<wire::Hello>(&message))
        return is_among(role,
                        hello->peer == wire::PeerKind::Node ? wire::Senders::Nodes : wire::Senders::Clients);
    return is_among(role, wire::table::Control::senders(message));
}

bool allowed(net::Role role, const wire::BulkMessage& message) {
    return is_among(role, wire::table::Bulk::senders(message));
}

}  // namespace tessera::master
