#pragma once

#include <glm/gtc/type_ptr.hpp>
#include <optional>
#include <type_traits>
#include <variant>
#include <vector>

#include "mediator/base/hash.h"
#include "mediator/codec/field_types.h"
#include "mediator/codec/format.h"

// One codec for all described structures: the bytes are those of the messages in proto/.
//
//     C++                                      proto3
//     bool, unsigned, enumeration, id          bool, uint32, uint64; with FullWidth fixed64
//     signed, Duration (ns)                    sint32, sint64
//     float, double                            float, double
//     std::string, Hash256 (empty = all zero)  bytes
//     glm vectors and matrices                 repeated float or double of that number, matrices by column
//     set with bits() and from_bits()          uint32
//     structure, variant                       message, message with a oneof
//     std::optional of a number or structure   optional
//     std::vector                              repeated; of glm types: one after another
//
// As in proto3, zero numbers and empty strings and lists are left out, so that an absent number is 0 even if its initial
// value is another one; an absent vector or structure keeps its initial value. With InitialWhenAbsent numbers are always
// written, and an absent one has its initial value. Unknown fields are skipped. Decoders throw Error{InvalidInput};
// they allocate memory in proportion to the bytes received, never to a number in them.
namespace tessera::codec {

// Maximum entries of a list without a Limit, as many as fit into a control message.
inline constexpr Limit DefaultLimit{65536};

// Fields of a structure: bit i is the row with number i + 1. Numbers beyond 64 cannot be masked.
using RowMask = std::uint64_t;
inline constexpr RowMask AllRows = ~RowMask{0};

template <Described T>
void write_rows(FormatWriter& out, const T& value, RowMask mask = AllRows);
template <Described T>
void read_rows(FormatReader& in, T& value, RowMask mask = AllRows);

template <detail::Message T>
void write_content(FormatWriter& out, const T& value);
template <detail::Message T>
void read_content(FormatReader& in, T& value);

// ---- one field ----

namespace detail {

template <class T>
constexpr WireType wire_type(bool full_width) {
    if constexpr (Number<T>) {
        return number_type<T>(full_width);
    } else if constexpr (Set<T>) {
        return WireType::Varint;
    } else if constexpr (is_optional<T>) {
        return wire_type<typename T::value_type>(full_width);
    } else {
        return WireType::Length;
    }
}

template <Message T>
void write_message(FormatWriter& out, std::uint32_t tag, const T& value) {
    const std::size_t start = out.begin(tag);
    write_content(out, value);
    out.end(start);
}

template <class T>
void write_list(FormatWriter& out, std::uint32_t tag, const std::vector<T>& values) {
    if constexpr (Message<T>) {
        for (const T& value : values) write_message(out, tag, value);
    } else if constexpr (std::is_same_v<T, std::string>) {
        for (const T& value : values) out.block(tag, value.data(), value.size());
    } else if (values.empty()) {
        return;
    } else if constexpr (Packed<T>::count > 0) {
        out.block(tag, values.data(), values.size() * sizeof(T));
    } else {
        static_assert(Number<T>);
        const std::size_t start = out.begin(tag);
        for (const T& value : values) out.varint(to_bits(value, false));
        out.end(start);
    }
}

template <unsigned Number_, bool Full, bool Always = false, class T>
void write_field(FormatWriter& out, const T& value) {
    constexpr WireType Type = wire_type<T>(Full);
    constexpr std::uint32_t Tag = make_tag(Number_, Type);
    if constexpr (Number<T>) {
        const std::uint64_t bits = to_bits(value, Full);
        if (!Always && bits == 0) return;
        out.varint(Tag);
        put_bits(out, Type, bits);
    } else if constexpr (Set<T>) {
        write_field<Number_, Full>(out, value.bits());
    } else if constexpr (std::is_same_v<T, std::string>) {
        if (!value.empty()) out.block(Tag, value.data(), value.size());
    } else if constexpr (std::is_same_v<T, Hash256>) {
        if (value != Hash256{}) out.block(Tag, value.bytes.data(), value.bytes.size());
    } else if constexpr (Vector<T>) {
        out.block(Tag, glm::value_ptr(value), sizeof value);
    } else if constexpr (is_list<T>) {
        write_list(out, Tag, value);
    } else if constexpr (is_optional<T>) {
        if (!value) return;
        if constexpr (Number<typename T::value_type>) {
            out.varint(Tag);
            put_bits(out, Type, to_bits(*value, Full));
        } else {
            write_message(out, Tag, *value);
        }
    } else {
        write_message(out, Tag, value);
    }
}

template <Message T>
void read_message(FormatReader& in, T& value) {
    FormatReader content(in.block(), in);
    read_content(content, value);
}

template <class T>
void read_packed(FormatReader& in, std::vector<T>& values, std::size_t limit) {
    const auto bytes = in.block();
    if constexpr (Packed<T>::count > 0) {
        if (bytes.size() % sizeof(T) != 0) in.fail("a list ends within an entry");
        const std::size_t before = values.size(), more = bytes.size() / sizeof(T);
        if (more > limit - before) in.fail("a list is too long");
        values.resize(before + more);
        if (more > 0) std::memcpy(static_cast<void*>(values.data() + before), bytes.data(), bytes.size());
    } else {
        FormatReader numbers(bytes, in);
        while (!numbers.at_end()) {
            if (values.size() >= limit) in.fail("a list is too long");
            values.push_back(from_bits<T>(numbers, numbers.varint()));
        }
    }
}

// The entries of one field: one message or string, or all numbers of a packed list.
template <class T>
void read_entries(FormatReader& in, std::vector<T>& values, std::size_t limit) {
    in.enter_entry(values.size());
    if constexpr (Message<T> || std::is_same_v<T, std::string>) {
        if (values.size() >= limit) in.fail("a list is too long");
        if constexpr (Message<T>) {
            read_message(in, values.emplace_back());
        } else {
            const auto bytes = in.block();
            values.emplace_back(reinterpret_cast<const char*>(bytes.data()), bytes.size());
        }
    } else {
        read_packed(in, values, limit);
    }
}

template <bool Full, class T>
void read_field(FormatReader& in, T& value, std::size_t limit) {
    constexpr WireType Type = wire_type<T>(Full);
    if constexpr (Number<T>) {
        value = from_bits<T>(in, get_bits(in, Type));
    } else if constexpr (Set<T>) {
        decltype(value.bits()) bits{};
        read_field<Full>(in, bits, limit);
        value = T::from_bits(bits);
        if (value.bits() != bits) in.fail("a set has an unknown member");
    } else if constexpr (std::is_same_v<T, std::string>) {
        const auto bytes = in.block();
        value.assign(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    } else if constexpr (std::is_same_v<T, Hash256>) {
        const auto bytes = in.block();
        if (!bytes.empty() && bytes.size() != value.bytes.size()) in.fail("a hash has the wrong length");
        value = {};
        std::copy(bytes.begin(), bytes.end(), value.bytes.begin());
    } else if constexpr (Vector<T>) {
        const auto bytes = in.block();
        if (bytes.size() != sizeof value) in.fail("a vector has the wrong length");
        std::memcpy(glm::value_ptr(value), bytes.data(), bytes.size());
    } else if constexpr (is_list<T>) {
        read_entries(in, value, limit);
    } else if constexpr (is_optional<T>) {
        read_field<Full>(in, value.emplace(), limit);
    } else {
        read_message(in, value);
    }
}

// Sets the value of an absent field.
template <class T>
void set_absent(T& value) {
    if constexpr (Number<T> || Set<T> || std::is_same_v<T, Hash256>) {
        value = T{};
    } else if constexpr (is_list<T> || std::is_same_v<T, std::string>) {
        value.clear();
    } else if constexpr (is_optional<T>) {
        value.reset();
    }
}

template <Described T, std::size_t I>
struct RowTraits {
    static constexpr const auto& row = row_of<T, I>;
    using RowType = std::remove_cvref_t<decltype(row)>;
    static constexpr bool full_width = RowType::template has<FullWidth>;
    static constexpr bool initial_when_absent = RowType::template has<InitialWhenAbsent>;
    static constexpr std::size_t limit() {
        if constexpr (RowType::template has<Limit>) {
            return row.template note<Limit>().entries;
        } else {
            return DefaultLimit.entries;
        }
    }
    using Value = RowValue<T, I>;
    static constexpr std::uint32_t tag = make_tag(row.number, wire_type<Value>(full_width));
};

template <unsigned Number_>
constexpr bool in_mask(RowMask mask) {
    return Number_ > 64 || ((mask >> ((Number_ - 1) % 64)) & 1) != 0;
}

template <Described T, std::size_t I>
void read_row(FormatReader& in, T& value) {
    using Traits = RowTraits<T, I>;
    in.enter(Traits::row.name);
    set_row<I>(value, [&](auto& part) {
        read_field<Traits::full_width>(in, part, Traits::limit());
        if (!within<I, T>(part)) in.fail("an enumerator is not allowed here");
    });
}

template <Described T, std::size_t I>
void set_row_absent(T& value) {
    using Traits = RowTraits<T, I>;
    if constexpr (Traits::initial_when_absent) {
        Traits::row.of(value) = Traits::row.of(initial<T>());
    } else if constexpr (!is_computed<typename Traits::RowType>) {
        set_absent(Traits::row.of(value));
    } else if constexpr (Number<typename Traits::Value>) {
        Traits::row.access.set(value, {});
    }
}

}  // namespace detail

// ---- messages ----

// The rows whose bits are in the mask, in their order.
template <Described T>
void write_rows(FormatWriter& out, const T& value, RowMask mask) {
    for_each_row<T>([&]<std::size_t I>(std::integral_constant<std::size_t, I>) {
        using Traits = detail::RowTraits<T, I>;
        if (!detail::in_mask<Traits::row.number>(mask)) return;
        detail::write_field<Traits::row.number, Traits::full_width, Traits::initial_when_absent>(
            out, row_value<I>(value));
    });
}

// Reads to the end of `in`. Members that are not in the mask stay unchanged.
template <Described T>
void read_rows(FormatReader& in, T& value, RowMask mask) {
    for_each_row<T>([&]<std::size_t I>(std::integral_constant<std::size_t, I>) {
        if (detail::in_mask<row_of<T, I>.number>(mask)) detail::set_row_absent<T, I>(value);
    });
    std::uint32_t tag = in.tag();
    while (tag != 0) {
        bool taken = false;
        // Fields usually arrive in the order of the rows, so one pass over the rows reads them all.
        for_each_row<T>([&]<std::size_t I>(std::integral_constant<std::size_t, I>) {
            if (!detail::in_mask<row_of<T, I>.number>(mask)) return;
            while (tag == detail::RowTraits<T, I>::tag) {
                detail::read_row<T, I>(in, value);
                tag = in.tag();
                taken = true;
            }
        });
        if (taken) continue;
        in.skip(tag);
        tag = in.tag();
    }
    if (const char* what = why_malformed(value)) in.fail(what);
}

// The active alternative, with the rows whose bits are in the mask.
template <Oneof T>
void write_oneof(FormatWriter& out, const T& value, RowMask mask = AllRows) {
    for_each_alternative<T>([&]<class A>(const Alternative<A>& alternative) {
        const auto* held = std::get_if<A>(&value);
        if (held == nullptr) return;
        const std::size_t start = out.begin(make_tag(alternative.number, WireType::Length));
        write_rows(out, *held, mask);
        out.end(start);
    });
}

// The last alternative wins.
template <Oneof T>
void read_oneof(FormatReader& in, T& value, RowMask mask = AllRows) {
    bool found = false;
    while (const std::uint32_t tag = in.tag()) {
        bool taken = false;
        for_each_alternative<T>([&]<class A>(const Alternative<A>& alternative) {
            if (tag != make_tag(alternative.number, WireType::Length)) return;
            in.enter(alternative.name);
            FormatReader content(in.block(), in);
            read_rows(content, value.template emplace<A>(), mask);
            taken = true;
        });
        found |= taken;
        if (!taken) in.skip(tag);
    }
    if (!found) in.fail("of an unknown kind");
}

template <detail::Message T>
void write_content(FormatWriter& out, const T& value) {
    if constexpr (detail::Custom<T>) {
        CustomCodec<T>::write(out, value);
    } else if constexpr (Oneof<T>) {
        write_oneof(out, value);
    } else {
        write_rows(out, value);
    }
}

template <detail::Message T>
void read_content(FormatReader& in, T& value) {
    if constexpr (detail::Custom<T>) {
        CustomCodec<T>::read(in, value);
    } else if constexpr (Oneof<T>) {
        read_oneof(in, value);
    } else {
        read_rows(in, value);
    }
}

// Throws Error{InvalidInput} when it would be longer than 2 GiB.
template <detail::Message T>
std::vector<std::byte> to_bytes(const T& value) {
    FormatWriter out;
    write_content(out, value);
    return out.take();
}

// Decodes any bytes to a value, or Error{InvalidInput}.
template <detail::Message T>
Expected<T> from_bytes(std::span<const std::byte> bytes) {
    try {
        T value{};
        FormatReader in(bytes);
        read_content(in, value);
        return value;
    } catch (const Error& error) {
        return tl::unexpected(error);
    }
}

}  // namespace tessera::codec
