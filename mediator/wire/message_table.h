#pragma once

#include <algorithm>
#include <cstdint>
#include <initializer_list>
#include <string_view>
#include <tuple>
#include <variant>

#include "mediator/base/description.h"

// The messages of a link, one row each: number and name on the wire, structure, and the roles that may send it to a master.
namespace tessera::wire {

enum class Senders : std::uint8_t {
    Master,  // sent by the master only
    Nodes,
    Editors,
    Operators,
    Clients,  // including viewers
    Everyone,
};

template <std::size_t N>
struct Literal {
    char text[N];
    constexpr Literal(const char (&from)[N]) { std::copy_n(from, N, text); }
};

template <unsigned Number, Literal Name, class M, Senders From>
struct MessageRow {
    using Type = M;
    static constexpr unsigned number = Number;
    static constexpr Senders senders = From;
    static constexpr Alternative<M> alternative() { return {Number, Name.text}; }
};

template <class... Rows>
struct MessageTable {
    using Message = std::variant<typename Rows::Type...>;
    static constexpr auto alternatives() { return std::tuple(Rows::alternative()...); }
    static constexpr unsigned number(const Message& message) {
        constexpr unsigned Numbers[] = {Rows::number...};
        return Numbers[message.index()];
    }
    static constexpr Senders senders(const Message& message) {
        constexpr Senders From[] = {Rows::senders...};
        return From[message.index()];
    }
    static constexpr std::string_view name(const Message& message) {
        constexpr std::string_view Names[] = {Rows::alternative().name...};
        return Names[message.index()];
    }
    // Calls `use(message, name)` with a default message of each row.
    static void for_each(const auto& use) {
        (use(Message(typename Rows::Type{}), Rows::alternative().name), ...);
    }
    static constexpr bool has(unsigned number) { return ((number == Rows::number) || ...); }
    // No duplicate numbers, and no retired ones.
    static constexpr bool is_valid(std::initializer_list<unsigned> retired) {
        unsigned numbers[] = {Rows::number...};
        std::sort(std::begin(numbers), std::end(numbers));
        return std::adjacent_find(std::begin(numbers), std::end(numbers)) == std::end(numbers) &&
               std::none_of(retired.begin(), retired.end(), has);
    }
};

}  // namespace tessera::wire
