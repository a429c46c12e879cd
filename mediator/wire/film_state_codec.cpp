#include "mediator/wire/film_state_codec.h"

#include "mediator/codec/byte_stream.h"
#include "mediator/wire/envelope.h"

namespace tessera::wire {

using codec::ByteReader;
using codec::ByteWriter;

frame::FilmTile without_samples(const frame::WantedSamples& wanted, frame::ChannelSet channels) {
    frame::ChannelSet one;
    channels.for_each([&](const frame::ChannelInfo& info) {
        one.insert(info.channel);
        return false;
    });
    return {wanted.tile, wanted.block, one, wanted.pixels};
}

std::vector<std::byte> encode(const frame::FilmState& film) {
    std::size_t size = sizeof film.steps;
    for (const frame::FilmTile& block : film.blocks) size += block.byte_size() + 512;
    ByteWriter out(size);
    out.put(film.steps);
    const auto put = [&](const frame::FilmTile& tile, bool is_wanted) {
        const std::vector<std::byte> message =
            encode(BulkMessage(FilmBlock{.count = 1, .is_wanted = is_wanted, .film = tile}));
        out.put(static_cast<std::uint32_t>(message.size()));
        out.put_all(std::span(message));
    };
    for (const frame::FilmTile& block : film.blocks) put(block, false);
    if (film.blocks.empty()) return out.take();  // there is no step without samples
    for (const frame::WantedSamples& wanted : film.wanted)
        put(without_samples(wanted, film.blocks.front().channels), true);
    return out.take();
}

Expected<frame::FilmState> decode_film_state(std::span<const std::byte> bytes) {
    try {
        frame::FilmState film;
        ByteReader in(bytes);
        film.steps = in.get<std::uint32_t>();
        while (!in.rest().empty()) {
            const auto size = in.get<std::uint32_t>();
            if (size > in.rest().size()) in.fail("it ends too early");
            auto message = decode_bulk(in.rest().first(size));
            if (!message) return tl::unexpected(message.error());
            auto* block = std::get_if<FilmBlock>(&*message);
            if (block == nullptr) in.fail("it is not film");
            if (block->is_wanted) {
                film.wanted.push_back({block->film.rect, block->film.block, std::move(block->film.pixels)});
            } else {
                film.blocks.push_back(std::move(block->film));
            }
            in.skip(size);
        }
        return film;
    } catch (const Error& error) {
        return tl::unexpected(error);
    }
}

}  // namespace tessera::wire
