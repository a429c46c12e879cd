#pragma once

#include <google/protobuf/descriptor.h>
#include <google/protobuf/message.h>

#include "tests/wire/described_values.h"

// Compares descriptions of structures with the compiled files of proto/, and what the codec writes with what libprotobuf
// reads. tests/wire only.
namespace tessera::wire::test {

using Field = google::protobuf::FieldDescriptor;
using ProtoMessage = google::protobuf::Message;

template <class T>
constexpr Field::Type proto_type(bool full_width) {
    if constexpr (std::is_same_v<T, bool>) {
        return Field::TYPE_BOOL;
    } else if constexpr (std::is_same_v<T, float>) {
        return Field::TYPE_FLOAT;
    } else if constexpr (std::is_same_v<T, double>) {
        return Field::TYPE_DOUBLE;
    } else if constexpr (std::is_same_v<T, Duration>) {
        return Field::TYPE_SINT64;
    } else if constexpr (std::is_enum_v<T> || detail::Set<T>) {
        return Field::TYPE_UINT32;
    } else if constexpr (detail::is_id<T> || std::is_integral_v<T>) {
        if (full_width) return Field::TYPE_FIXED64;
        if (std::is_signed_v<T>) return sizeof(T) == 8 ? Field::TYPE_SINT64 : Field::TYPE_SINT32;
        return sizeof(T) == 8 ? Field::TYPE_UINT64 : Field::TYPE_UINT32;
    } else if constexpr (std::is_same_v<T, std::string> || std::is_same_v<T, Hash256>) {
        return Field::TYPE_BYTES;
    } else {
        return Field::TYPE_MESSAGE;
    }
}

// One value of a field.
template <class T>
struct ElementOf {
    using Type = T;
};
template <class T>
struct ElementOf<std::vector<T>> : ElementOf<T> {};
template <class T>
struct ElementOf<std::optional<T>> : ElementOf<T> {};
template <detail::Vector T>
struct ElementOf<T> {
    using Type = typename detail::Packed<T>::Element;
};

template <class T>
void expect_same_message(const google::protobuf::Descriptor& proto);

template <Described T, std::size_t I>
void expect_same_field(const google::protobuf::Descriptor& proto) {
    using Traits = detail::RowTraits<T, I>;
    using Value = typename Traits::Value;
    using Element = typename ElementOf<Value>::Type;
    const Field* field = proto.FindFieldByNumber(static_cast<int>(Traits::row.number));
    ASSERT_NE(field, nullptr) << proto.full_name() << " lacks " << Traits::row.name;
    EXPECT_EQ(field->name(), Traits::row.name) << proto.full_name();
    EXPECT_EQ(field->type() == Field::TYPE_ENUM ? Field::TYPE_UINT32 : field->type(),
              proto_type<Element>(Traits::full_width))
        << field->full_name();
    EXPECT_EQ(field->is_repeated(), detail::is_list<Value> || detail::Vector<Value>) << field->full_name();
    if (proto_type<Element>(false) != Field::TYPE_MESSAGE) {
        EXPECT_EQ(field->has_optional_keyword(), detail::is_optional<Value> || Traits::initial_when_absent)
            << field->full_name();
    }
    if (field->is_repeated() && field->type() != Field::TYPE_BYTES && field->type() != Field::TYPE_MESSAGE) {
        EXPECT_TRUE(field->is_packed()) << field->full_name();
    }
    if constexpr (detail::Message<Element>) {
        ASSERT_NE(field->message_type(), nullptr);
        expect_same_message<Element>(*field->message_type());
    }
}

template <class T>
void expect_same_message(const google::protobuf::Descriptor& proto) {
    if constexpr (Described<T>) {
        EXPECT_EQ(static_cast<int>(row_count<T>), proto.field_count()) << proto.full_name();
        for_each_row<T>(
            [&]<std::size_t I>(std::integral_constant<std::size_t, I>) { expect_same_field<T, I>(proto); });
    } else if constexpr (Oneof<T>) {
        ASSERT_EQ(proto.oneof_decl_count(), 1) << proto.full_name();
        EXPECT_EQ(proto.oneof_decl(0)->field_count(), static_cast<int>(std::variant_size_v<T>));
        for_each_alternative<T>([&]<class A>(const Alternative<A>& alternative) {
            const Field* field = proto.FindFieldByNumber(static_cast<int>(alternative.number));
            ASSERT_NE(field, nullptr) << proto.full_name() << " lacks " << alternative.name;
            EXPECT_EQ(field->name(), alternative.name);
            EXPECT_NE(field->containing_oneof(), nullptr);
            ASSERT_NE(field->message_type(), nullptr);
            expect_same_message<A>(*field->message_type());
        });
    }
}

// In a message and all its sub-messages.
inline int unknown_fields(const ProtoMessage& message) {
    const auto* reflection = message.GetReflection();
    int count = reflection->GetUnknownFields(message).field_count();
    std::vector<const Field*> set;
    reflection->ListFields(message, &set);
    for (const Field* field : set) {
        if (field->type() != Field::TYPE_MESSAGE) continue;
        if (!field->is_repeated()) count += unknown_fields(reflection->GetMessage(message, field));
        for (int i = 0; field->is_repeated() && i < reflection->FieldSize(message, field); ++i)
            count += unknown_fields(reflection->GetRepeatedMessage(message, field, i));
    }
    return count;
}

// Random values written by encode() are read completely by libprotobuf, and libprotobuf's encoding of them is decoded to
// the same value.
template <class T, class Proto, class Encode, class Decode>
void expect_same_bytes(int runs, const Encode& encode, const Decode& decode) {
    CounterRandom random(7);
    for (int run = 0; run < runs; ++run) {
        T value{};
        fill(value, random);
        const std::vector<std::byte> bytes = encode(value);
        Proto message;
        ASSERT_TRUE(message.ParseFromArray(bytes.data(), static_cast<int>(bytes.size())));
        EXPECT_EQ(unknown_fields(message), 0) << message.GetTypeName();
        std::string back;
        ASSERT_TRUE(message.SerializeToString(&back));
        const auto decoded = decode(std::as_bytes(std::span(back)));
        ASSERT_TRUE(decoded) << message.GetTypeName() << ": " << decoded.error().what();
        EXPECT_EQ(encode(*decoded), bytes) << message.GetTypeName();
    }
}

template <class T, class Proto, class Encode, class Decode>
void expect_contract(int runs, const Encode& encode, const Decode& decode) {
    expect_same_message<T>(*Proto::descriptor());
    expect_same_bytes<T, Proto>(runs, encode, decode);
}

}  // namespace tessera::wire::test
