// Decoding arbitrary bytes gives a value or an Error, never a crash or exception, and accepted values encode to the same
// message.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <functional>
#include <limits>

#include "mediator/base/random.h"
#include "mediator/scene/fields.h"
#include "mediator/wire/envelope.h"
#include "tests/wire/sample_messages.h"

namespace tessera::wire {
namespace {

using Bytes = std::vector<std::byte>;

TEST(ControlMessages, EveryKindIsTested) {
    const auto messages = control_messages();
    ASSERT_EQ(messages.size(), std::variant_size_v<ControlMessage>);
    for (std::size_t i = 0; i < messages.size(); ++i) EXPECT_EQ(messages[i].index(), i);
}

TEST(ControlMessages, RoundTrip) {
    for (const ControlMessage& message : control_messages()) {
        const Bytes bytes = encode(message);
        const auto decoded = decode_control(bytes);
        ASSERT_TRUE(decoded) << message.index() << ": " << decoded.error().what();
        EXPECT_EQ(decoded->index(), message.index());
        EXPECT_EQ(encode(*decoded), bytes) << "kind " << message.index();
    }
}

TEST(ControlMessages, AnUpdateCarriesTheFieldsOfItsMaskOnly) {
    scene::Transform moved;
    moved.name = std::string(500, 'x');
    moved.children.assign(1000, ObjectId{5});
    const scene::Update update{ObjectId{8}, scene::Fields<scene::Transform>(&scene::Transform::matrix).bits(),
                               moved};
    EXPECT_LT(encode(ControlMessage(Changes{{.entries = {update}}})).size(), 300u);
}

TEST(BulkMessages, RoundTrip) {
    for (const BulkMessage& message : bulk_messages()) {
        const Bytes bytes = encode(message);
        EXPECT_TRUE(is_bulk(bytes));
        const auto decoded = decode_bulk(bytes);
        ASSERT_TRUE(decoded) << message.index() << ": " << decoded.error().what();
        EXPECT_EQ(encode(*decoded), bytes);
    }
}

TEST(BulkMessages, UniformCountsAreEncodedWithoutAPlane) {
    const auto messages = bulk_messages();
    EXPECT_EQ(encode(messages[4]).size() + 5 * sizeof(std::uint32_t), encode(messages[5]).size());
}

template <class Decode>
void attack(const Bytes& good, CounterRandom& random, const Decode& decode) {
    for (std::size_t size = 0; size < good.size(); size += 1 + size / 16) {
        decode(std::span(good).first(size));
    }
    for (int i = 0; i < 2000; ++i) {
        Bytes bad = good;
        const std::uint64_t flips = 1 + random.below(4);
        for (std::uint64_t f = 0; f < flips && !bad.empty(); ++f) {
            bad[random.below(bad.size())] ^= static_cast<std::byte>(1u << random.below(8));
        }
        if (random.below(4) == 0) bad.resize(random.below(bad.size() + 9));
        decode(std::span<const std::byte>(bad));
    }
}

// Accepted values have to survive another round trip.
TEST(MalformedBytes, OnTheControlLinkGiveAValueOrAnError) {
    CounterRandom random(1);
    for (const ControlMessage& message : control_messages()) {
        attack(encode(message), random, [](std::span<const std::byte> bytes) {
            const auto decoded = decode_control(bytes);
            if (!decoded) return;
            EXPECT_TRUE(decode_control(encode(*decoded)));
        });
    }
    EXPECT_FALSE(decode_control(Bytes(64 * 1024 + 1)));
}

TEST(MalformedBytes, OnTheBulkLinkGiveAValueOrAnError) {
    CounterRandom random(2);
    for (const BulkMessage& message : bulk_messages()) {
        attack(encode(message), random, [](std::span<const std::byte> bytes) {
            const auto decoded = decode_bulk(bytes);
            if (!decoded) return;
            EXPECT_TRUE(decode_bulk(encode(*decoded)));
        });
    }
}

TEST(MalformedBytes, InChangeListsGiveAValueOrAnError) {
    CounterRandom random(3);
    attack(encode(some_changes()), random,
           [](std::span<const std::byte> bytes) { (void)decode_change_list(bytes); });
    attack(encode(scene::Edit{SessionId{1}, 2, {3, 4}, some_changes().entries}), random,
           [](std::span<const std::byte> bytes) { (void)decode_edit(bytes); });
}

// Each of these removals takes six bytes, and would take some hundred in memory.
TEST(MalformedBytes, AnEditOfTooManyEntriesIsRefusedBeforeItTakesMemory) {
    const Bytes one = encode(scene::Edit{.entries = {scene::Remove{ObjectId{7}}}});
    Bytes bytes;
    for (std::size_t i = 0; i <= scene::MaxEditEntries; ++i)
        bytes.insert(bytes.end(), one.begin(), one.end());
    const EditSize size = measure_edit(bytes);
    EXPECT_EQ(size.entries, scene::MaxEditEntries + 1);
    EXPECT_GT(size.bytes, scene::MaxEditEntries * sizeof(scene::Entry));
    const auto decoded = decode_edit(bytes);
    ASSERT_FALSE(decoded);
    EXPECT_STREQ(decoded.error().what(),
                 "an edit of 2000001 entries is longer than one may be, 2000000: make it in parts");
    bytes.resize(2 * one.size());
    ASSERT_TRUE(decode_edit(bytes));
    EXPECT_EQ(decode_edit(bytes)->entries.size(), 2u);
    bytes.resize(one.size() - 1);
    EXPECT_EQ(measure_edit(bytes).entries, 0u) << "it ends within an entry";
}

// The field number precedes the value; nothing else in these messages has the same bytes.
TEST(MalformedBytes, UnknownRenderersAreRefused) {
    const auto with = [](const ControlMessage& message, std::byte value, std::byte instead) {
        Bytes bytes = encode(message);
        const std::array<std::byte, 2> field{std::byte{14 << 3}, value};
        const auto place = std::search(bytes.begin(), bytes.end(), field.begin(), field.end());
        EXPECT_NE(place, bytes.end());
        place[1] = instead;
        return decode_control(bytes);
    };
    const ControlMessage view = OpenView{some_view()};
    EXPECT_TRUE(with(view, std::byte{2}, std::byte{1}));
    EXPECT_FALSE(with(view, std::byte{2}, std::byte{4}));
    const ControlMessage hello = Hello{.peer = PeerKind::Node, .renderers = {view::Renderer::Raster}};
    EXPECT_TRUE(with(hello, std::byte{4}, std::byte{5}));
    EXPECT_FALSE(with(hello, std::byte{4}, std::byte{16}));
}

// Also those that a later version may have: beyond 31 in a film's header, beyond 63 in a message.
TEST(MalformedBytes, UnknownChannelsAreRefused) {
    for (const unsigned number : {unsigned{frame::ChannelCount}, 30u, 31u, 63u, 64u, 127u}) {
        OpenView open{some_view()};
        EXPECT_TRUE(decode_control(encode(ControlMessage(open))));
        open.view.channels.insert(static_cast<frame::Channel>(number));
        EXPECT_FALSE(decode_control(encode(ControlMessage(open)))) << number;
        Hello hello{.peer = PeerKind::Node};
        hello.channels.insert(static_cast<frame::Channel>(number));
        EXPECT_FALSE(decode_control(encode(ControlMessage(hello)))) << number;
        FilmPart part = std::get<FilmPart>(bulk_messages()[4]);
        part.film.channels.insert(static_cast<frame::Channel>(number));
        const auto refused = decode_bulk(encode(BulkMessage(part)));
        ASSERT_FALSE(refused) << number;
        EXPECT_NE(std::string(refused.error().what()).find("a channel is unknown"), std::string::npos);
    }
}

TEST(MalformedBytes, ViewsOfChannelsThatCannotBeRenderedAreRefused) {
    using frame::Channel;
    const auto reason = [](frame::ChannelSet channels) {
        OpenView open{some_view()};
        open.view.channels = channels;
        const auto decoded = decode_control(encode(ControlMessage(open)));
        return decoded ? std::string() : std::string(decoded.error().what());
    };
    EXPECT_EQ(reason({Channel::Radiance, Channel::BlockVariance, Channel::FirstHalf}), "");
    EXPECT_NE(reason({Channel::Radiance, Channel::HalfBufferA}).find("request first_half"),
              std::string::npos);
    EXPECT_NE(reason({Channel::Color, Channel::BlockVariance}).find("need radiance"), std::string::npos);
}

TEST(MalformedBytes, ViewsWithAClampThatIsNoLimitAreRefused) {
    OpenView open{some_view()};
    for (const float clamp :
         {-1.0f, -std::numeric_limits<float>::infinity(), std::numeric_limits<float>::quiet_NaN()}) {
        open.view.clamp_indirect = clamp;
        const auto decoded = decode_control(encode(ControlMessage(open)));
        ASSERT_FALSE(decoded) << clamp;
        EXPECT_NE(std::string(decoded.error().what()).find("clamp_indirect"), std::string::npos);
    }
}

// Film that would corrupt the frame does not decode.
TEST(MalformedBytes, InvalidFilmIsRefused) {
    const auto refused = [](const std::function<void(FilmPart&)>& forge) {
        FilmPart part = std::get<FilmPart>(bulk_messages()[4]);
        forge(part);
        return !decode_bulk(encode(BulkMessage(part)));
    };
    EXPECT_FALSE(refused([](FilmPart&) {}));
    EXPECT_TRUE(refused([](FilmPart& part) { part.film.counts[0] = 5; }))
        << "more samples than the block has";
    EXPECT_TRUE(refused([](FilmPart& part) { part.film.counts[0] = 3; })) << "a sample is missing";
    EXPECT_TRUE(
        refused([](FilmPart& part) { part.film.planes[1] = std::numeric_limits<float>::quiet_NaN(); }));
    EXPECT_TRUE(refused([](FilmPart& part) { part.film.block = {5, 2}; })) << "not aligned";
    EXPECT_TRUE(refused([](FilmPart& part) { part.film.rect.x = -1; }));
    EXPECT_TRUE(refused([](FilmPart& part) { part.film.planes.pop_back(); }));
}

TEST(MalformedBytes, MasksThatDoNotFitTheirTileAreRefused) {
    const auto unit_refused = [](std::string mask) {
        Work work{.sequence = 1, .unit = {.id = UnitId{1}, .tile = {0, 0, 5, 2}, .block = {4, 2}}};
        work.unit.mask = std::move(mask);
        return !decode_control(encode(ControlMessage(work)));
    };
    EXPECT_FALSE(unit_refused(""));
    EXPECT_FALSE(unit_refused(std::string("\x01\x02", 2)));
    for (const std::string& mask : {std::string("\x01"), std::string("\0\0", 2), std::string("\x01\x04", 2),
                                    std::string("\xff\x03", 2), std::string(3, '\x01')})
        EXPECT_TRUE(unit_refused(mask));
    FilmPart part{.unit = UnitId{1},
                  .film = frame::FilmTile({0, 0, 5, 2}, {4, 0}, {frame::Channel::Radiance},
                                          frame::PixelSet({1, 8}, 10))};
    part.film.counts = {1, 1};
    const std::vector<std::byte> good = encode(BulkMessage(part));
    const auto decoded = decode_bulk(good);
    ASSERT_TRUE(decoded);
    EXPECT_TRUE(identical_bits(std::get<FilmPart>(*decoded).film, part.film));
    EXPECT_EQ(film_head(good)->mask, std::string("\x02\x01", 2));
    for (const std::uint8_t flag : {4, 8, 64, 128}) {
        std::vector<std::byte> bad = good;
        bad[good.size() - 2 * 6 * sizeof(float) - 4 - 2 - 1] |= std::byte{flag};
        EXPECT_FALSE(decode_bulk(bad)) << int{flag} << " is no flag";
    }
    const frame::FilmTile whole({0, 0, 5, 2}, {4, 0}, {frame::Channel::Radiance});
    part.film = whole;
    part.film.counts.assign(10, 1);
    EXPECT_EQ(encode(BulkMessage(part)).size() - good.size(), 8u * 6 * sizeof(float) - 2)
        << "as many planes as pixels";
    // Each bit, those of the mask among them.
    std::size_t accepted = 0;
    for (std::size_t i = 0; i < 8 * good.size(); ++i) {
        std::vector<std::byte> bad = good;
        bad[i / 8] ^= std::byte{1} << (i % 8);
        if (const auto head = film_head(bad); head && !decode_bulk(bad)) ++accepted;
    }
    EXPECT_GT(accepted, 16u) << "the header alone does not show it";
}

// Every plane of every channel, by its merge rule.
TEST(MalformedBytes, ImpossibleValuesInAnyPlaneAreRefused) {
    constexpr float Infinity = std::numeric_limits<float>::infinity();
    constexpr float NotANumber = std::numeric_limits<float>::quiet_NaN();
    for (const frame::ChannelInfo& info : frame::channel_table()) {
        frame::ChannelSet channels{info.channel};
        if (info.is_derived()) channels.insert(frame::Channel::Radiance);
        for (std::uint32_t plane = 0; plane < info.plane_count(); ++plane) {
            const auto is_refused = [&](float value) {
                FilmPart part{.unit = UnitId{1}, .film = frame::FilmTile({0, 0, 2, 1}, {0, 0}, channels)};
                part.film.counts = {1, 1};
                part.film.plane(channels.first_plane(info.channel) + plane)[1] = value;
                return !decode_bulk(encode(BulkMessage(part)));
            };
            const bool is_mean = info.rule == frame::MergeRule::Moments && plane < info.components;
            // Sums of squares may overflow.
            const bool is_square = (info.rule == frame::MergeRule::Moments && !is_mean) ||
                                   info.rule == frame::MergeRule::BlockVariance;
            const bool is_count = info.rule == frame::MergeRule::FirstHalf && plane == 3;
            const bool is_minimum = info.rule == frame::MergeRule::Minimum ||
                                    (info.rule == frame::MergeRule::Nearest && plane == 0);
            const bool is_bits = info.rule == frame::MergeRule::Nearest && plane > 0;
            EXPECT_FALSE(is_refused(1.0f)) << info.name << " " << plane;
            EXPECT_EQ(is_refused(NotANumber), !is_bits) << info.name << " " << plane;
            EXPECT_EQ(is_refused(Infinity), !is_bits && !is_minimum && !is_square)
                << info.name << " " << plane;
            EXPECT_EQ(is_refused(-Infinity), !is_bits) << info.name << " " << plane;
            EXPECT_EQ(is_refused(-1.0f), is_square || is_count) << info.name << " " << plane;
        }
    }
}

// The event loop decides by the header alone.
TEST(MalformedBytes, TheHeadOfFilmIsReadWithoutItsPlanes) {
    const FilmPart part = std::get<FilmPart>(bulk_messages()[4]);
    const Bytes bytes = encode(BulkMessage(part));
    const auto head = film_head(bytes);
    ASSERT_TRUE(head);
    EXPECT_EQ(head->unit, part.unit);
    EXPECT_EQ(head->view, part.view);
    EXPECT_EQ(head->revision, part.revision);
    EXPECT_EQ(head->version, part.version);
    EXPECT_EQ(head->rect, part.film.rect);
    EXPECT_EQ(head->block, part.film.block);
    EXPECT_FALSE(film_head(encode(bulk_messages()[0])));
    for (std::size_t length = 0; length < bytes.size(); ++length)
        (void)film_head(std::span(bytes).first(length));
    for (std::size_t i = 0; i < bytes.size(); ++i) {
        Bytes damaged = bytes;
        damaged[i] ^= std::byte{0xff};
        (void)film_head(damaged);
    }
}

// Sizes in a header are checked before memory is allocated for them.
TEST(MalformedBytes, HugeSizesAreNotAllocated) {
    Bytes bytes = encode(bulk_messages()[4]);
    const std::size_t rect = bytes.size() - (4 + 4 * 6 * (6 + 2)) - 1 - 8 - 4 - 4 - 8 - 16;
    Rect there;
    std::memcpy(&there, bytes.data() + rect, sizeof there);
    ASSERT_EQ(there, std::get<FilmPart>(bulk_messages()[4]).film.rect)
        << "the header has changed: look for it";
    const std::array<std::int32_t, 2> huge{65536, 65536};
    std::memcpy(bytes.data() + rect + 8, huge.data(), sizeof huge);
    EXPECT_FALSE(decode_bulk(bytes));
    EXPECT_FALSE(decode_bulk(encode(BulkMessage(BlobChunk{blake2b({}), ~0ull, ~0ull - 5, Bytes(50)}))));
}

}  // namespace
}  // namespace tessera::wire
