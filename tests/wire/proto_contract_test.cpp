// The C++ descriptions agree with the files of proto/ field by field, and the codec's bytes with libprotobuf, so neither
// can change without the other.
#include "tests/wire/proto_contract.h"

#include "mediator/wire/display_codec.h"
#include "mediator/wire/envelope.h"
#include "mediator/wire/journal_codec.h"
#include "proto/control.pb.h"
#include "proto/journal.pb.h"

namespace tessera::wire::test {
namespace {

// A function object for the overloaded codec functions.
constexpr auto encoded = [](const auto& value) { return encode(value); };

TEST(ProtoContract, ControlMessages) {
    expect_contract<ControlMessage, proto::Control>(400, encoded,
                                                    [](auto bytes) { return decode_control(bytes); });
}

TEST(ProtoContract, ChangeLists) {
    expect_contract<scene::ChangeList, proto::ChangeList>(
        50, encoded, [](auto bytes) { return decode_change_list(bytes); });
    expect_same_message<scene::Object>(*proto::Object::descriptor());
}

TEST(ProtoContract, RecordsOfTheJournal) {
    expect_contract<JournalRecord, proto::JournalRecord>(
        50, encoded, [](auto bytes) { return decode_journal_record(bytes); });
}

TEST(ProtoContract, Displays) {
    expect_contract<display::Display, proto::Display>(20, encoded,
                                                      [](auto bytes) { return decode_display(bytes); });
}

// A checkpoint has to be consistent, so random values cannot be used.
TEST(ProtoContract, Checkpoints) {
    expect_same_message<CheckpointState>(*proto::Checkpoint::descriptor());
    expect_same_message<StoredJob>(*proto::StoredJob::descriptor());
}

// Retired numbers of oneofs are never reused.
TEST(ProtoContract, NumbersOfRemovedMessagesAreReserved) {
    const auto& proto = *proto::Control::descriptor();
    int last = 0;
    for (int i = 0; i < proto.field_count(); ++i) last = std::max(last, proto.field(i)->number());
    for (int number = 1; number <= last; ++number) {
        EXPECT_TRUE(proto.FindFieldByNumber(number) != nullptr || proto.IsReservedNumber(number))
            << number << " is neither a message nor reserved";
    }
}

// A structure before and after a row was added.
struct Early {
    float size = 2.0f;
    static constexpr auto describe(auto row) { return std::tuple(row(1, "size", &Early::size)); }
};
struct Late {
    float size = 2.0f, edge = 0.5f;
    std::uint32_t count = 7;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "size", &Late::size), row(2, "edge", &Late::edge, InitialWhenAbsent{}),
                          row(3, "count", &Late::count, InitialWhenAbsent{}));
    }
};

TEST(LaterRows, HaveTheirDefaultValueWhenAbsent) {
    const auto read = from_bytes<Late>(to_bytes(Early{.size = 0.0f}));
    ASSERT_TRUE(read);
    EXPECT_EQ(read->size, 0.0f);
    EXPECT_EQ(read->edge, 0.5f);
    EXPECT_EQ(read->count, 7u);
    const auto zero = from_bytes<Late>(to_bytes(Late{.edge = 0.0f, .count = 0}));
    ASSERT_TRUE(zero);
    EXPECT_EQ(zero->edge, 0.0f);
    EXPECT_EQ(zero->count, 0u);
    EXPECT_EQ(from_bytes<Early>(to_bytes(Late{.size = 3.0f}))->size, 3.0f) << "older readers skip it";
}

struct OlderBackground {
    float rotation = 0.25f;
    static constexpr auto describe(auto row) {
        return std::tuple(row(5, "rotation", &OlderBackground::rotation));
    }
};

// Backgrounds of older versions keep their look: the middle of their map is -z.
TEST(LaterRows, HaveTheOldMeaningWhenAbsent) {
    const auto read = from_bytes<scene::Background>(to_bytes(OlderBackground{}));
    ASSERT_TRUE(read);
    EXPECT_EQ(read->rotation, 0.25f);
    EXPECT_EQ(read->map_center, scene::MapCenter::NegativeZ);
    EXPECT_EQ(from_bytes<scene::Background>(to_bytes(scene::Background{}))->map_center,
              scene::MapCenter::PositiveX);
}

}  // namespace
}  // namespace tessera::wire::test
