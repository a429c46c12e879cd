#pragma once

#include <gtest/gtest.h>

#include "mediator/base/random.h"
#include "mediator/wire/codec.h"

// Values of described structures: any, by chance. tests/wire only.
namespace tessera::wire::test {

template <class T>
void fill(T& value, CounterRandom& random);

template <Described T>
void fill_rows(T& value, CounterRandom& random) {
    for_each_row<T>([&]<std::size_t I>(std::integral_constant<std::size_t, I>) {
        using Traits = detail::RowTraits<T, I>;
        if constexpr (is_computed<typename Traits::RowType>) {
            typename Traits::Value part{};
            fill(part, random);
            Traits::row.access.set(value, part);
        } else {
            fill(Traits::row.of(value), random);
        }
    });
    // Rows whose values have to agree are as they are by default.
    if constexpr (requires { value.malformed(); }) {
        if constexpr (requires {
                          { value.malformed() } -> std::same_as<const char*>;
                      }) {
            if (value.malformed()) value = T{};
        }
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
    } else if constexpr (Described<T>) {
        fill_rows(value, random);
    } else {
        static_assert(detail::Oneof<T>);
        std::uint64_t left = random.below(std::variant_size_v<T>);
        detail::for_each_alternative<T>([&]<class A>(const Alternative<A>&) {
            if (left-- == 0) fill(value.template emplace<A>(), random);
        });
    }
}

}  // namespace tessera::wire::test
