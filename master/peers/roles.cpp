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

std::string role_table() {
    constexpr net::Role Columns[] = {net::Role::Viewer, net::Role::Editor, net::Role::Node,
                                     net::Role::Operator};
    std::string table = "| message |";
    for (const net::Role role : Columns) table += std::string(" ") + net::name(role) + " |";
    table += "\n|---|---|---|---|---|\n";
    const auto add = [&](const auto& message, std::string_view name) {
        std::string row = "| `" + std::string(name) + "` |";
        bool any = false;
        for (const net::Role role : Columns) {
            row += allowed(role, message) ? " yes |" : "  |";
            any = any || allowed(role, message);
        }
        if (any) table += row + "\n";  // others are sent by the master
    };
    wire::table::Control::for_each([&](const wire::ControlMessage& message, std::string_view name) {
        if (!std::holds_alternative<wire::Hello>(message)) return add(message, name);
        add(wire::ControlMessage(wire::Hello{.peer = wire::PeerKind::Client}), "hello of a client");
        add(wire::ControlMessage(wire::Hello{.peer = wire::PeerKind::Node}), "hello of a node");
    });
    wire::table::Bulk::for_each(
        [&](const wire::BulkMessage& message, std::string_view name) { add(message, name); });
    return table;
}

}  // namespace tessera::master
