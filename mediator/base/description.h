#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>

// Compile-time reflection: structures describe their members once for codecs, masks, comparison, hashing and
// printing. A structure has one row per member, in the order of the bits of its masks:
//
//     struct Pick {
//         std::uint64_t request = 0;
//         std::vector<ObjectId> objects;
//         static constexpr auto describe(auto row) {
//             return std::tuple(row(1, "request", &Pick::request), row(2, "objects", &Pick::objects, Limit{16}));
//         }
//     };
//
// `describe` is a template, so that it costs no compile time where it is not used. The number is that of the field in
// proto/ and is never reused; the name is the field's, in snake_case. Any further arguments are notes: values that are
// looked up by their type. A structure may also have `const char* malformed() const`: null, or why a decoded value is
// invalid.
//
// An enumeration names its enumerators, which count from 0, next to its definition:
//
//     enum class Turn : std::uint8_t { None, Quarter };
//     constexpr auto enumerators(Turn) { return std::to_array<std::string_view>({"none", "quarter"}); }
//
// Alternatives of a variant that travels as a oneof are listed likewise, as a tuple of Alternative<T>:
//
//     constexpr auto alternatives(const Shape*) {
//         return std::tuple(Alternative<Circle>{1, "circle"}, Alternative<Square>{2, "square"});
//     }
namespace tessera {

// A note: the most entries that a list may have when it is decoded.
struct Limit {
    std::size_t entries;
};

// A note: the number has 8 bytes on the wire (fixed64), as random keys and hashes, which are rarely small.
struct FullWidth {};

// A note, of rows that were added after the first release; their field in proto/ is `optional`. If it is absent, the
// member has its default value, so that files and messages of older versions stay readable.
struct InitialWhenAbsent {};

// The same where older versions did what 0 stands for, which is not the default value.
struct ZeroWhenAbsent {};

// A default-initialised structure.
template <class T>
const T& initial() {
    static const T Value{};
    return Value;
}

// A note: enumerators beyond this one are rejected when decoding this field.
template <class E>
struct UpTo {
    E last;
};
template <class E>
UpTo(E) -> UpTo<E>;  // clang 16 does not deduce it

// A computed member: `get(const T&)` returns the described value, `set(T&, value)` stores it.
template <class Get, class Set>
struct Computed {
    Get get;
    Set set;
};
template <class Get, class Set>
Computed(Get, Set) -> Computed<Get, Set>;

// `Access` is a pointer to a member, a function from T& or const T& to a reference, or Computed.
template <class Access, class... Notes>
struct Row {
    unsigned number;
    std::string_view name;
    Access access;
    std::tuple<Notes...> notes;

    template <class Note>
    static constexpr bool has = (std::is_same_v<Note, Notes> || ...);
    template <class Note>
    constexpr const Note& note() const {
        return std::get<Note>(notes);
    }

    // The member itself; not for Computed.
    template <class T>
    constexpr auto& of(T& object) const {
        if constexpr (std::is_member_object_pointer_v<Access>) {
            return object.*access;
        } else {
            return access(object);
        }
    }
};

template <class T>
inline constexpr bool is_computed = false;
template <class Get, class Set, class... Notes>
inline constexpr bool is_computed<Row<Computed<Get, Set>, Notes...>> = true;

struct MakeRow {
    template <class Access, class... Notes>
    constexpr auto operator()(unsigned number, std::string_view name, Access access, Notes... notes) const {
        return Row<Access, Notes...>{number, name, access, std::tuple<Notes...>(notes...)};
    }
};

template <class T>
concept Described = requires {
    T::describe(MakeRow{});
};

template <Described T>
inline constexpr auto rows_of = T::describe(MakeRow{});

template <Described T>
inline constexpr std::size_t row_count = std::tuple_size_v<std::remove_const_t<decltype(rows_of<T>)>>;

// The I-th row.
template <Described T, std::size_t I>
inline constexpr const auto& row_of = std::get<I>(rows_of<T>);

// The value of the I-th row: a reference to the member, or the computed value.
template <std::size_t I, Described T>
constexpr decltype(auto) row_value(const T& object) {
    constexpr const auto& row = row_of<T, I>;
    if constexpr (is_computed<std::remove_cvref_t<decltype(row)>>) {
        return row.access.get(object);
    } else {
        return row.of(object);
    }
}
template <Described T, std::size_t I>
using RowValue = std::remove_cvref_t<decltype(row_value<I>(std::declval<const T&>()))>;

// Calls fill(V&) with the member of the I-th row, or with a temporary that is then stored.
template <std::size_t I, Described T, class Fill>
constexpr void set_row(T& object, const Fill& fill) {
    constexpr const auto& row = row_of<T, I>;
    if constexpr (is_computed<std::remove_cvref_t<decltype(row)>>) {
        RowValue<T, I> value{};
        fill(value);
        row.access.set(object, std::move(value));
    } else {
        fill(row.of(object));
    }
}

// Whether a decoded value of the I-th row is within its UpTo, if it has one.
template <std::size_t I, Described T>
constexpr bool within(const RowValue<T, I>& value) {
    constexpr const auto& row = row_of<T, I>;
    if constexpr (std::remove_cvref_t<decltype(row)>::template has<UpTo<RowValue<T, I>>>) {
        return value <= row.template note<UpTo<RowValue<T, I>>>().last;
    } else {
        return true;
    }
}

// Null, or why this decoded value is invalid.
template <Described T>
constexpr const char* why_malformed(const T& value) {
    if constexpr (requires {
                      { value.malformed() } -> std::same_as<const char*>;
                  }) {
        return value.malformed();
    } else {
        return nullptr;
    }
}

// Calls visit(std::integral_constant<std::size_t, I>) for every row, in order.
template <Described T, class Visit>
constexpr void for_each_row(Visit&& visit) {
    [&]<std::size_t... I>(std::index_sequence<I...>) {
        (visit(std::integral_constant<std::size_t, I>{}), ...);
    }
    (std::make_index_sequence<row_count<T>>{});
}

template <class E>
concept Enumerated = std::is_enum_v<E> && requires(E value) {
    enumerators(value).size();
};

template <Enumerated E>
inline constexpr std::size_t enumerator_count = enumerators(E{}).size();

// "" for values that are not enumerators.
template <Enumerated E>
constexpr std::string_view enumerator_name(E value) {
    const auto index = static_cast<std::size_t>(value);
    return index < enumerator_count<E> ? enumerators(E{})[index] : std::string_view{};
}

template <Enumerated E>
constexpr std::optional<E> enumerator_named(std::string_view name) {
    for (std::size_t i = 0; i < enumerator_count<E>; ++i) {
        if (enumerators(E{})[i] == name) return static_cast<E>(i);
    }
    return std::nullopt;
}

template <class T>
struct Alternative {
    using Type = T;
    unsigned number;
    std::string_view name;
};

template <class T>
concept Oneof = requires(const T* value) {
    alternatives(value);
};

template <Oneof T>
inline constexpr auto alternatives_of = alternatives(static_cast<const T*>(nullptr));

// Calls visit(const Alternative<A>&) for each.
template <Oneof T, class Visit>
constexpr void for_each_alternative(const Visit& visit) {
    std::apply([&](const auto&... alternative) { (visit(alternative), ...); }, alternatives_of<T>);
}

}  // namespace tessera
