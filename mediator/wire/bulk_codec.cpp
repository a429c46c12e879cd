#include <algorithm>
#include <concepts>

#include "mediator/codec/byte_stream.h"
#include "mediator/codec/field_types.h"
#include "mediator/display/display.h"
#include "mediator/wire/envelope.h"

// Every bulk message: magic, number, then the fields of its rows, then raw data. Little-endian; enumerations and booleans
// have 4 bytes.
namespace tessera::wire {

using namespace codec;

namespace {

constexpr std::uint32_t Magic = 0x31525354;              // "TSR1"
constexpr std::size_t MaxPixels = std::size_t{1} << 16;  // of a film tile: 256 x 256
constexpr std::size_t HeaderRoom = 256;
// Flags of film.
constexpr std::uint8_t UniformCounts = 1;  // one count for all pixels instead of a plane
constexpr std::uint8_t Masked = 2;         // a mask follows: counts and planes have its pixels alone

using Data = std::vector<std::byte>;

// Channels below 31 as the bits of one number; with others its highest bit is set, and all of them follow.
constexpr std::uint32_t AllChannelsFollow = 1u << 31;

void put_channels(ByteWriter& out, const frame::ChannelSet& channels) {
    const frame::ChannelSet::Words& words = channels.words();
    if (words[0] < AllChannelsFollow && words[1] == 0) return out.put(static_cast<std::uint32_t>(words[0]));
    out.put(AllChannelsFollow);
    for (const std::uint64_t word : words) out.put(word);
}

frame::ChannelSet get_channels(ByteReader& in) {
    frame::ChannelSet::Words words{in.get<std::uint32_t>(), 0};
    if (words[0] == AllChannelsFollow) {
        for (std::uint64_t& word : words) word = in.get<std::uint64_t>();
    }
    const auto channels = frame::ChannelSet::from_words(words);
    if (channels.empty()) in.fail("it has no channels");
    if (const char* reason = channels.malformed()) in.fail(reason);
    return channels;
}

void put_film(ByteWriter& out, const frame::FilmTile& film) {
    out.put(film.rect);
    out.put(film.block.first);
    out.put(film.block.level);
    put_channels(out, film.channels);
    out.put(film.nonfinite_samples);
    const std::string mask = film.pixels.bits(film.rect.pixel_count());
    const bool uniform =
        !film.counts.empty() && std::all_of(film.counts.begin(), film.counts.end(),
                                            [&](std::uint32_t n) { return n == film.counts[0]; });
    out.put(static_cast<std::uint8_t>((uniform ? UniformCounts : 0) | (mask.empty() ? 0 : Masked)));
    out.put_all(std::span(mask));
    if (uniform) {
        out.put(film.counts[0]);
    } else {
        out.put_all(std::span(film.counts));
    }
    out.put_all(std::span(film.planes));
}

// All but counts and planes.
struct FilmHeader {
    Rect rect;
    frame::SampleBlock block;
    frame::ChannelSet channels;
    std::uint64_t nonfinite = 0;
    bool has_uniform_counts = false;
    std::string mask;  // as view::WorkUnit::mask
};
FilmHeader get_film_header(ByteReader& in) {
    FilmHeader header{.rect = in.get<Rect>(), .block = {}, .channels = {}, .mask = {}};
    header.block.first = in.get<std::uint64_t>();
    header.block.level = in.get<std::uint32_t>();
    constexpr std::int32_t MaxEdge = 65536;
    const Rect& rect = header.rect;
    if (rect.empty() || rect.x < 0 || rect.y < 0 || rect.width > MaxEdge || rect.height > MaxEdge ||
        rect.x > MaxEdge || rect.y > MaxEdge || rect.pixel_count() > MaxPixels) {
        in.fail("the tile's size is absurd");
    }
    if (header.block.level >= 32 || !header.block.is_aligned()) in.fail("a block of samples is not aligned");
    header.channels = get_channels(in);
    header.nonfinite = in.get<std::uint64_t>();
    const auto flags = in.get<std::uint8_t>();
    if ((flags & ~(UniformCounts | Masked)) != 0) in.fail("it has unknown flags");
    header.has_uniform_counts = (flags & UniformCounts) != 0;
    if ((flags & Masked) == 0) return header;
    const std::size_t bytes = (rect.pixel_count() + 7) / 8;
    if (bytes > in.rest().size()) in.fail("it ends too early");  // before it is allocated
    header.mask.resize(bytes);
    in.fill(std::span(header.mask));
    return header;
}

frame::FilmTile get_film(ByteReader& in) {
    const FilmHeader header = get_film_header(in);
    const std::size_t all = header.rect.pixel_count();
    auto pixels = frame::PixelSet::from_bits(header.mask, all);
    if (!pixels) in.fail("the mask does not fit the tile");
    // The size is known before anything is allocated.
    const std::size_t count = pixels->count(all);
    const std::size_t expected =
        (header.has_uniform_counts ? 4 : 4 * count) + 4 * header.channels.plane_count() * count;
    if (in.rest().size() != expected) in.fail("the planes have another size than the header says");
    frame::FilmTile film(header.rect, header.block, header.channels, *std::move(pixels));
    film.nonfinite_samples = header.nonfinite;
    if (header.has_uniform_counts) {
        std::fill(film.counts.begin(), film.counts.end(), in.get<std::uint32_t>());
    } else {
        in.fill(std::span(film.counts));
    }
    in.fill(std::span(film.planes));
    return film;
}

// Values that a back-end cannot have computed would corrupt the film that they are merged with.
const char* malformed_plane(const frame::ChannelInfo& info, std::uint32_t plane,
                            std::span<const float> values) {
    constexpr float Largest = std::numeric_limits<float>::max();
    const auto all = [&](const auto& is_fine) { return std::all_of(values.begin(), values.end(), is_fine); };
    const auto finite = [&] { return all([](float v) { return v >= -Largest && v <= Largest; }); };
    switch (info.rule) {
        case frame::MergeRule::Moments:
            if (plane < info.components) return finite() ? nullptr : "a mean is not finite";
            // +inf: squares of differences above 1.8e19 overflow.
            return all([](float v) { return v >= 0.0f; }) ? nullptr
                                                          : "a sum of squares is negative or not a number";
        case frame::MergeRule::Sum:
            return finite() ? nullptr : "a sum is not finite";
        case frame::MergeRule::Minimum:  // +inf: nothing was found
            return all([](float v) { return v >= -Largest; }) ? nullptr : "a minimum is not a number";
        case frame::MergeRule::Maximum:
            return all([](float v) { return v <= Largest; }) ? nullptr : "a maximum is not a number";
        case frame::MergeRule::Nearest:  // the key; the others hold any bits
            if (plane > 0) return nullptr;
            return all([](float v) { return v >= -Largest; }) ? nullptr : "a distance is not a number";
        case frame::MergeRule::First:
            return nullptr;
        case frame::MergeRule::BlockVariance:  // +inf as above
            return all([](float v) { return v >= 0.0f; }) ? nullptr : "an error is negative or not a number";
        case frame::MergeRule::FirstHalf:
            if (plane == 3 && !all([](float v) { return v >= 0.0f; })) return "a count is negative";
            return finite() ? nullptr : "a mean is not finite";
    }
    return nullptr;
}

// Checks counts and all planes.
const char* malformed_block(const frame::FilmTile& film) {
    const std::uint64_t limit = film.block.count();
    std::uint64_t accepted = 0;
    for (const std::uint32_t count : film.counts) {
        if (count > limit) return "a pixel has more samples than its block";
        accepted += count;
    }
    if (accepted + film.nonfinite_samples != limit * film.pixel_count()) return "the counts do not add up";
    const char* problem = nullptr;
    std::uint32_t first = 0;
    film.channels.for_each([&](const frame::ChannelInfo& info) {
        for (std::uint32_t plane = 0; plane < info.plane_count() && problem == nullptr; ++plane)
            problem = malformed_plane(info, plane, film.plane(first + plane));
        first += info.plane_count();
        return problem == nullptr;
    });
    return problem;
}

template <Described T>
void put_rows(ByteWriter& out, const T& value);
template <Described T>
void get_rows(ByteReader& in, T& value);

template <class T>
void put(ByteWriter& out, const T& value) {
    if constexpr (std::is_same_v<T, frame::FilmTile>) {
        put_film(out, value);
    } else if constexpr (std::is_same_v<T, Data>) {
        out.put_all(std::span(value));
    } else if constexpr (Described<T>) {
        put_rows(out, value);
    } else if constexpr (std::is_enum_v<T> || std::is_same_v<T, bool>) {
        out.put(static_cast<std::uint32_t>(value));
    } else {
        out.put(value);
    }
}

template <class T>
void get(ByteReader& in, T& value) {
    if constexpr (std::is_same_v<T, frame::FilmTile>) {
        value = get_film(in);
    } else if constexpr (std::is_same_v<T, Data>) {
        if (in.rest().size() > MaxChunk) in.fail("a chunk is longer than 1 MiB");
        value.resize(in.rest().size());
        in.fill(std::span(value));
    } else if constexpr (Described<T>) {
        get_rows(in, value);
    } else if constexpr (std::is_same_v<T, bool>) {
        value = in.get<std::uint32_t>() != 0;
    } else if constexpr (std::is_enum_v<T>) {
        const auto number = in.get<std::uint32_t>();
        if (number >= enumerator_count<T>) in.fail("an enumerator is unknown");
        value = static_cast<T>(number);
    } else {
        value = in.get<T>();
    }
}

template <Described T>
void put_rows(ByteWriter& out, const T& value) {
    for_each_row<T>(
        [&]<std::size_t I>(std::integral_constant<std::size_t, I>) { put(out, row_value<I>(value)); });
}

template <Described T>
void get_rows(ByteReader& in, T& value) {
    for_each_row<T>([&]<std::size_t I>(std::integral_constant<std::size_t, I>) {
        set_row<I>(value, [&]<class V>(V& part) {
            get(in, part);
            if (!within<I, T>(part)) in.fail("an enumerator is not allowed here");
        });
    });
    if (const char* what = why_malformed(value)) in.fail(what);
}

// Size of the data after the header.
std::size_t size_of_data(const BulkMessage& message) {
    return std::visit(
        []<class M>(const M& value) -> std::size_t {
            if constexpr (requires { value.data; }) return value.data.size();
            if constexpr (requires { value.film; }) return value.film.byte_size();
            return 0;
        },
        message);
}

std::optional<std::uint32_t> number_of(std::span<const std::byte> bytes) {
    if (bytes.size() < 8) return std::nullopt;
    ByteReader in(bytes);
    const auto magic = in.get<std::uint32_t>();
    const auto number = in.get<std::uint32_t>();
    return magic == Magic && table::Bulk::has(number) ? std::optional(number) : std::nullopt;
}

}  // namespace

const char* FilmPart::malformed() const {
    return malformed_block(film);
}

const char* FilmBlock::malformed() const {
    if (index >= count) return "a tile's index is not below the tile count";
    if (!is_wanted) return malformed_block(film);
    const auto is_zero = [](std::uint32_t n) { return n == 0; };
    return std::ranges::all_of(film.counts, is_zero) ? nullptr : "pixels that are to get samples have them";
}

// The film is put together in memory of this size: no larger than any view's.
const char* FrameHeader::malformed() const {
    constexpr std::uint64_t MaxFilmPixels = std::uint64_t{1} << 28;
    constexpr std::int32_t MaxEdge = 65536;
    if (scale == 0) return "a scale of 0";
    if (!(mean_samples >= 0.0 && noise >= 0.0)) return "a number of samples or a noise that is no number";
    if ((film_tiles == 0) != film_window.empty()) return "film without a window, or a window without film";
    if (film_tiles == 0) return nullptr;
    if (film_window.x < 0 || film_window.y < 0 || film_window.width > MaxEdge ||
        film_window.height > MaxEdge || film_window.pixel_count() > MaxFilmPixels ||
        film_tiles > film_window.pixel_count())
        return "the film's window is absurd";
    return nullptr;
}

const char* OutputPicture::malformed() const {
    if (eyes != 1 && eyes != 2) return "a frame for another number of eyes";
    if (encoding != session::PictureEncoding::Bytes && encoding != session::PictureEncoding::Half)
        return "an output's picture is neither bytes nor half floats";
    const std::uint64_t bytes_per_pixel = encoding == session::PictureEncoding::Bytes ? 3 : 6;
    if (width == 0 || height == 0 || width > display::MaxEdge || height > display::MaxEdge ||
        total != bytes_per_pixel * width * height)
        return "an output's picture has another size than its header says";
    return malformed_piece(total, offset, data.size());
}

std::vector<std::byte> encode(const BulkMessage& message) {
    ByteWriter out(HeaderRoom + size_of_data(message));
    out.put(Magic);
    out.put(table::Bulk::number(message));
    std::visit([&](const auto& value) { put_rows(out, value); }, message);
    return out.take();
}

bool is_bulk(std::span<const std::byte> bytes) {
    return number_of(bytes).has_value();
}

bool is_film(std::span<const std::byte> bytes) {
    return number_of(bytes) == table::Bulk::number(FilmPart{});
}

Expected<FilmHead> film_head(std::span<const std::byte> bytes) {
    if (!is_film(bytes)) return failure(ErrorCode::InvalidInput, "malformed message: not film");
    try {
        ByteReader in(bytes.subspan(8));
        FilmPart part;
        FilmHeader header;
        for_each_row<FilmPart>([&]<std::size_t I>(std::integral_constant<std::size_t, I>) {
            set_row<I>(part, [&]<class V>(V& value) {
                if constexpr (std::is_same_v<V, frame::FilmTile>) {
                    header = get_film_header(in);
                } else {
                    get(in, value);
                }
            });
        });
        return FilmHead{part.unit,   part.view,    part.revision,         part.version,
                        header.rect, header.block, std::move(header.mask)};
    } catch (const Error& error) {
        return tl::unexpected(error);
    }
}

Expected<BulkMessage> decode_bulk(std::span<const std::byte> bytes) {
    const auto number = number_of(bytes);
    if (!number) return failure(ErrorCode::InvalidInput, "malformed message: not a bulk message");
    try {
        BulkMessage message;
        ByteReader in(bytes.subspan(8));
        for_each_alternative<BulkMessage>([&]<class M>(const Alternative<M>& alternative) {
            if (alternative.number == *number) get_rows(in, message.emplace<M>());
        });
        if (!in.rest().empty()) in.fail("bytes are left over");
        return message;
    } catch (const Error& error) {
        return tl::unexpected(error);
    }
}

}  // namespace tessera::wire
