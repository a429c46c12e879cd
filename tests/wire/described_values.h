#pragma once

#include <gtest/gtest.h>

#include "mediator/base/random.h"
#include "mediator/codec/codec.h"
#include "mediator/scene/change_list.h"
#include "mediator/scene/fields.h"
#include "mediator/wire/journal_records.h"

// Random values of described structures. tests/wire only.
namespace tessera::wire::test {

namespace detail = codec::detail;
using codec::from_bytes, codec::to_bytes;

template <class T>
void fill(T& value, CounterRandom& random);

// Templates instantiated for many types: kept small.
template <Described T>
[[gnu::noinline]] void fill_rows(T& value, CounterRandom& random) {
    for_each_row<T>([&]<std::size_t I>(std::integral_constant<std::size_t, I>) {
        set_row<I>(value, [&](auto& part) {
            do {
                fill(part, random);
            } while (!within<I, T>(part));
        });
    });
    if constexpr (std::is_same_v<T, RecordedChange>) {
        if (value.before) value.mask &= scene::all_fields(*value.before);
        if (value.after) value.mask &= scene::all_fields(*value.after);
    }
    if constexpr (requires { value.channels.words(); })  // those that there are
        value.channels = frame::ChannelSet::all() - (frame::ChannelSet::all() - value.channels);
    if (why_malformed(value) != nullptr) value = T{};  // members have to agree: as they do by default
}

inline void fill_entry(scene::Entry& entry, CounterRandom& random) {
    const ObjectId id{random.below(1000)};
    scene::Object object;
    fill(object, random);
    switch (random.below(3)) {
        case 0:
            entry = scene::Create{id, object};
            break;
        case 1:
            entry = scene::Update{id, random.below(~0ull) & scene::all_fields(object), object};
            break;
        default:
            entry = scene::Remove{id};
    }
}

template <class T>
void fill(T& value, CounterRandom& random) {
    const std::uint64_t some =
        random.below(4) == 0 ? 0 : random.below(1u << 16) * random.below(1u << 15) + random.below(200);
    if constexpr (std::is_same_v<T, bool>) {
        value = some % 2 != 0;
    } else if constexpr (Enumerated<T>) {
        value = static_cast<T>(some % enumerator_count<T>);
    } else if constexpr (detail::is_id<T>) {
        value = T{some};
    } else if constexpr (std::is_same_v<T, Duration>) {
        value = Duration(static_cast<std::int64_t>(some) - 1000);
    } else if constexpr (std::is_floating_point_v<T>) {
        value = static_cast<T>(some) / 7 - 100;
    } else if constexpr (std::is_integral_v<T>) {
        value = static_cast<T>(some);
    } else if constexpr (detail::Set<T>) {
        value = T::from_bits(static_cast<std::uint32_t>(some));
    } else if constexpr (std::is_same_v<T, std::string>) {
        value.resize(random.below(200));
        for (char& c : value) c = static_cast<char>(random.below(256));
    } else if constexpr (std::is_same_v<T, Hash256>) {
        for (std::byte& byte : value.bytes) byte = static_cast<std::byte>(random.below(256));
    } else if constexpr (detail::Vector<T>) {
        for (std::size_t i = 0; i < detail::Packed<T>::count; ++i) fill(glm::value_ptr(value)[i], random);
    } else if constexpr (detail::is_list<T>) {
        value.resize(random.below(4));
        for (auto& entry : value) fill(entry, random);
    } else if constexpr (detail::is_optional<T>) {
        value.reset();
        if (random.below(2) == 0) fill(value.emplace(), random);
    } else if constexpr (std::is_same_v<T, scene::Entry>) {
        fill_entry(value, random);
    } else if constexpr (Described<T>) {
        fill_rows(value, random);
    } else {
        static_assert(Oneof<T>);
        std::uint64_t left = random.below(std::variant_size_v<T>);
        for_each_alternative<T>([&]<class A>(const Alternative<A>&) {
            if (left-- == 0) fill(value.template emplace<A>(), random);
        });
    }
}

}  // namespace tessera::wire::test
