#include <algorithm>
#include <utility>

#include "mediator/wire/byte_stream.h"
#include "mediator/wire/envelope.h"

// Every bulk message: magic, kind, then the fields in the order of the structure, then raw data.
// Little-endian.
namespace tessera::wire {

namespace {

constexpr std::uint32_t Magic = 0x31525354;  // "TSR1"
constexpr std::size_t MaxChunk = std::size_t{1} << 20;
constexpr std::size_t MaxPixels = std::size_t{1} << 16;  // of a film tile: 256 x 256
constexpr std::size_t HeaderRoom = 256;
constexpr std::uint8_t UniformCounts = 1;  // one count for all pixels instead of a plane

void put(ByteWriter& out, const Hash256& hash) {
    out.put(hash.bytes);
}

void put(ByteWriter& out, const frame::FilmTile& film) {
    out.put(film.rect);
    out.put(film.block.first);
    out.put(film.block.level);
    out.put(film.channels.bits());
    out.put(film.nonfinite_samples);
    const bool uniform =
        !film.counts.empty() && std::all_of(film.counts.begin(), film.counts.end(),
                                            [&](std::uint32_t n) { return n == film.counts[0]; });
    out.put(uniform ? UniformCounts : std::uint8_t{0});
    if (uniform) {
        out.put(film.counts[0]);
    } else {
        out.put_all(std::span(film.counts));
    }
    out.put_all(std::span(film.planes));
}

frame::FilmTile get_film(ByteReader& in) {
    const auto rect = in.get<Rect>();
    frame::SampleBlock block;
    block.first = in.get<std::uint64_t>();
    block.level = in.get<std::uint32_t>();
    const auto bits = in.get<std::uint32_t>();
    const auto nonfinite = in.get<std::uint64_t>();
    const auto channels = frame::ChannelSet::from_bits(bits);
    constexpr std::int32_t MaxEdge = 65536;
    if (rect.empty() || rect.x < 0 || rect.y < 0 || rect.width > MaxEdge || rect.height > MaxEdge ||
        rect.x > MaxEdge || rect.y > MaxEdge || rect.pixel_count() > MaxPixels) {
        malformed("the tile's size is absurd");
    }
    if (channels.bits() != bits || channels.empty()) malformed("a channel is unknown");
    if (block.level >= 32 || !block.is_aligned()) malformed("a block of samples is not aligned");
    const bool uniform = in.get<std::uint8_t>() == UniformCounts;
    // The size is known before anything is allocated.
    const std::size_t pixels = rect.pixel_count();
    const std::size_t expected = (uniform ? 4 : 4 * pixels) + 4 * channels.plane_count() * pixels;
    if (in.rest().size() != expected) malformed("the planes have another size than the header says");
    frame::FilmTile film(rect, block, channels);
    film.nonfinite_samples = nonfinite;
    if (uniform) {
        std::fill(film.counts.begin(), film.counts.end(), in.get<std::uint32_t>());
    } else {
        in.fill(std::span(film.counts));
    }
    in.fill(std::span(film.planes));
    return film;
}

// Non-finite moments, or more samples than a block can hold, would poison what they are merged with.
void check_block(const frame::FilmTile& film) {
    const std::uint64_t limit = film.block.count();
    std::uint64_t accepted = 0;
    for (const std::uint32_t count : film.counts) {
        if (count > limit) malformed("a pixel has more samples than its block");
        accepted += count;
    }
    if (accepted + film.nonfinite_samples != limit * film.pixel_count())
        malformed("the counts do not add up");
    for (const frame::ChannelInfo& info : frame::channel_table()) {
        if (!film.channels.contains(info.channel) || info.rule != frame::MergeRule::Moments) continue;
        const std::uint32_t first = film.channels.first_plane(info.channel);
        for (std::uint32_t plane = 0; plane < info.components; ++plane) {
            for (const float mean : film.plane(first + plane)) {
                if (!(mean >= -std::numeric_limits<float>::max() &&
                      mean <= std::numeric_limits<float>::max())) {
                    malformed("a mean is not finite");
                }
            }
        }
    }
}

struct Encoder {
    ByteWriter& out;
    void operator()(const BulkHello& hello) const { out.put(hello.token); }
    void operator()(const BlobRequest& request) const {
        put(out, request.hash);
        out.put(request.offset);
    }
    void operator()(const BlobChunk& chunk) const {
        put(out, chunk.hash);
        out.put(chunk.total);
        out.put(chunk.offset);
        out.put_all(std::span(chunk.data));
    }
    void operator()(const BlobAbsent& absent) const { put(out, absent.hash); }
    void operator()(const FilmPart& part) const {
        out.put(part.unit.value);
        out.put(part.view.value);
        out.put(part.revision);
        out.put(part.version.epoch);
        out.put(part.version.number);
        out.put(part.part);
        out.put(part.parts);
        out.put(part.rays);
        out.put(part.busy_ns);
        put(out, part.film);
    }
    void operator()(const FrameTile& tile) const {
        out.put(tile.job.value);
        out.put(tile.index);
        out.put(tile.count);
        put(out, tile.film);
    }
    void operator()(const PictureChunk& chunk) const {
        out.put(chunk.job.value);
        out.put(chunk.total);
        out.put(chunk.offset);
        out.put_all(std::span(chunk.data));
    }
    void operator()(const LiveFrame& frame) const {
        out.put(frame.view);
        out.put(frame.frame);
        out.put(frame.version.epoch);
        out.put(frame.version.number);
        out.put(frame.revision);
        out.put(frame.scale);
        out.put(frame.width);
        out.put(frame.height);
        out.put(frame.components);
        out.put(static_cast<std::uint32_t>(frame.encoding));
        out.put(frame.picture_bytes);
        out.put(frame.film_tiles);
        out.put(frame.complete ? std::uint32_t{1} : std::uint32_t{0});
        out.put(frame.samples_least);
        out.put(frame.samples_most);
        out.put(frame.spp);
        put(out, frame.film_hash);
    }
    void operator()(const OutputPicture& picture) const {
        out.put(picture.frame);
        out.put(static_cast<std::uint32_t>(picture.eye));
        out.put(picture.eyes);
        out.put(picture.version.epoch);
        out.put(picture.version.number);
        out.put(picture.camera.world_from_camera);
        for (const double edge :
             {picture.camera.left, picture.camera.right, picture.camera.bottom, picture.camera.top})
            out.put(edge);
        out.put(picture.width);
        out.put(picture.height);
        out.put(static_cast<std::uint32_t>(picture.encoding));
        out.put(picture.samples);
        out.put(picture.total);
        out.put(picture.offset);
        out.put_all(std::span(picture.data));
    }
};

struct Decoder {
    ByteReader& in;
    void operator()(BulkHello& hello) const {
        hello.token = in.get<std::uint64_t>();
        in.expect_end();
    }
    void operator()(BlobRequest& request) const {
        request.hash.bytes = in.get<decltype(request.hash.bytes)>();
        request.offset = in.get<std::uint64_t>();
        in.expect_end();
    }
    void operator()(BlobChunk& chunk) const {
        chunk.hash.bytes = in.get<decltype(chunk.hash.bytes)>();
        get_piece(chunk);
    }
    void operator()(BlobAbsent& absent) const {
        absent.hash.bytes = in.get<decltype(absent.hash.bytes)>();
        in.expect_end();
    }
    void operator()(FilmPart& part) const {
        part.unit.value = in.get<std::uint64_t>();
        part.view.value = in.get<std::uint64_t>();
        part.revision = in.get<std::uint64_t>();
        part.version.epoch = in.get<std::uint64_t>();
        part.version.number = in.get<std::uint64_t>();
        part.part = in.get<std::uint16_t>();
        part.parts = in.get<std::uint16_t>();
        part.rays = in.get<std::uint64_t>();
        part.busy_ns = in.get<std::uint64_t>();
        if (part.parts == 0 || part.part >= part.parts) malformed("a part is not one of its parts");
        part.film = get_film(in);
        check_block(part.film);
    }
    void operator()(FrameTile& tile) const {
        tile.job.value = in.get<std::uint64_t>();
        tile.index = in.get<std::uint32_t>();
        tile.count = in.get<std::uint32_t>();
        if (tile.index >= tile.count) malformed("a tile is not one of its frame");
        tile.film = get_film(in);
    }
    void operator()(PictureChunk& chunk) const {
        chunk.job.value = in.get<std::uint64_t>();
        get_piece(chunk);
    }
    void operator()(LiveFrame& frame) const {
        frame.view = in.get<std::uint64_t>();
        frame.frame = in.get<std::uint64_t>();
        frame.version.epoch = in.get<std::uint64_t>();
        frame.version.number = in.get<std::uint64_t>();
        frame.revision = in.get<std::uint64_t>();
        frame.scale = in.get<std::uint32_t>();
        frame.width = in.get<std::uint32_t>();
        frame.height = in.get<std::uint32_t>();
        frame.components = in.get<std::uint32_t>();
        const auto encoding = in.get<std::uint32_t>();
        if (encoding > static_cast<std::uint32_t>(PictureEncoding::Exr)) malformed("an encoding is unknown");
        frame.encoding = static_cast<PictureEncoding>(encoding);
        frame.picture_bytes = in.get<std::uint64_t>();
        frame.film_tiles = in.get<std::uint32_t>();
        frame.complete = in.get<std::uint32_t>() != 0;
        frame.samples_least = in.get<std::uint64_t>();
        frame.samples_most = in.get<std::uint64_t>();
        frame.spp = in.get<std::uint64_t>();
        frame.film_hash.bytes = in.get<decltype(frame.film_hash.bytes)>();
        if (frame.scale == 0) malformed("a scale of 0");
        in.expect_end();
    }

    void operator()(OutputPicture& picture) const {
        picture.frame = in.get<std::uint64_t>();
        const auto eye = in.get<std::uint32_t>();
        if (eye > static_cast<std::uint32_t>(view::Eye::Right)) malformed("an eye is unknown");
        picture.eye = static_cast<view::Eye>(eye);
        picture.eyes = in.get<std::uint32_t>();
        if (picture.eyes != 1 && picture.eyes != 2) malformed("a frame for another number of eyes");
        picture.version.epoch = in.get<std::uint64_t>();
        picture.version.number = in.get<std::uint64_t>();
        picture.camera.world_from_camera = in.get<glm::dmat4>();
        picture.camera.left = in.get<double>();
        picture.camera.right = in.get<double>();
        picture.camera.bottom = in.get<double>();
        picture.camera.top = in.get<double>();
        picture.width = in.get<std::uint32_t>();
        picture.height = in.get<std::uint32_t>();
        const auto encoding = in.get<std::uint32_t>();
        if (encoding == static_cast<std::uint32_t>(PictureEncoding::Bytes)) {
            picture.encoding = PictureEncoding::Bytes;
        } else if (encoding == static_cast<std::uint32_t>(PictureEncoding::Half)) {
            picture.encoding = PictureEncoding::Half;
        } else {
            malformed("an output's picture is neither bytes nor half floats");
        }
        picture.samples = in.get<std::uint64_t>();
        get_piece(picture);
        const std::uint64_t bytes_per_pixel = picture.encoding == PictureEncoding::Bytes ? 3 : 6;
        if (picture.width == 0 || picture.height == 0 || picture.width > display::MaxEdge ||
            picture.height > display::MaxEdge ||
            picture.total != bytes_per_pixel * picture.width * picture.height)
            malformed("an output's picture has another size than its header says");
    }

  private:
    template <class Chunk>
    void get_piece(Chunk& chunk) const {
        chunk.total = in.get<std::uint64_t>();
        chunk.offset = in.get<std::uint64_t>();
        const auto rest = in.rest();
        if (rest.size() > MaxChunk) malformed("a chunk is longer than 1 MiB");
        if (chunk.offset > chunk.total || rest.size() > chunk.total - chunk.offset) {
            malformed("a chunk reaches beyond its whole");
        }
        chunk.data.assign(rest.begin(), rest.end());
    }
};

template <std::size_t... I>
BulkMessage bulk_alternative(std::size_t index, std::index_sequence<I...>) {
    BulkMessage message;
    ((index == I ? (void)message.emplace<I>() : (void)0), ...);
    return message;
}

std::size_t size_of_data(const BulkMessage& message) {
    if (const auto* chunk = std::get_if<BlobChunk>(&message)) return chunk->data.size();
    if (const auto* piece = std::get_if<PictureChunk>(&message)) return piece->data.size();
    if (const auto* picture = std::get_if<OutputPicture>(&message)) return picture->data.size();
    if (const auto* part = std::get_if<FilmPart>(&message)) return part->film.byte_size();
    if (const auto* tile = std::get_if<FrameTile>(&message)) return tile->film.byte_size();
    return 0;
}

}  // namespace

std::vector<std::byte> encode(const BulkMessage& message) {
    ByteWriter out(HeaderRoom + size_of_data(message));
    out.put(Magic);
    out.put(static_cast<std::uint32_t>(message.index()));
    std::visit(Encoder{out}, message);
    return out.take();
}

std::optional<std::size_t> bulk_kind(std::span<const std::byte> bytes) {
    if (bytes.size() < 8) return std::nullopt;
    ByteReader in(bytes);
    const auto magic = in.get<std::uint32_t>();
    const auto kind = in.get<std::uint32_t>();
    if (magic != Magic || kind >= std::variant_size_v<BulkMessage>) return std::nullopt;
    return kind;
}

std::optional<ViewId> film_view(std::span<const std::byte> bytes) {
    const auto kind = bulk_kind(bytes);
    if (!kind || *kind != BulkMessage(FilmPart{}).index() || bytes.size() < 24) return std::nullopt;
    ByteReader in(bytes.subspan(16));  // after magic, kind and unit
    return ViewId{in.get<std::uint64_t>()};
}

Expected<BulkMessage> decode_bulk(std::span<const std::byte> bytes) {
    const auto kind = bulk_kind(bytes);
    if (!kind) return failure(ErrorCode::InvalidInput, "malformed message: not a bulk message");
    BulkMessage message =
        bulk_alternative(*kind, std::make_index_sequence<std::variant_size_v<BulkMessage>>{});
    try {
        ByteReader in(bytes.subspan(8));
        std::visit(Decoder{in}, message);
        return message;
    } catch (const Error& error) {
        return tl::unexpected(error);
    }
}

}  // namespace tessera::wire
