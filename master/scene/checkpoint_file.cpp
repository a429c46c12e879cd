#include "master/scene/checkpoint_file.h"

#include "master/scene/hashed_file.h"
#include "mediator/wire/journal_codec.h"

namespace tessera::master {

namespace {

constexpr HashedFileWriter::Magic CheckpointMagic{'T', 'S', 'C', 'H', 'E', 'C', 'K', '1'};

void need(bool holds, const char* otherwise) {
    if (!holds) throw Error(ErrorCode::InvalidInput, otherwise);
}

wire::CheckpointState parse(HashedFile& in, std::uint64_t number) {
    need(in.number() == number, "its number does not match its file name");
    auto state = wire::decode_checkpoint(in.take(in.number()));
    if (!state) throw state.error();
    for (wire::SavedView& view : state->views) {
        for (; view.block_count > 0; --view.block_count) {
            auto film = wire::decode_film(in.take(in.number()));
            if (!film) throw film.error();
            view.blocks.push_back(std::move(*film));
        }
    }
    need(in.remaining() == 0, "unexpected data after its last block");
    return std::move(*state);
}

std::vector<std::byte> encoded(const wire::CheckpointState& state) {
    try {
        return wire::encode(state);
    } catch (const Error& error) {
        throw Error(error.code(),
                    "the scene with its history takes more than 2 GiB, which is what a checkpoint "
                    "can hold: remove objects; edits are still recorded (" +
                        std::string(error.what()) + ")");
    }
}

}  // namespace

std::uint64_t write_checkpoint(const std::filesystem::path& path, std::uint64_t number,
                               const wire::CheckpointState& state) {
    HashedFileWriter out(path, CheckpointMagic);
    out.put(number);
    {
        const std::vector<std::byte> bytes = encoded(state);
        out.put(std::uint64_t{bytes.size()});
        out.put(bytes);
    }
    for (const wire::SavedView& view : state.views) {
        for (const frame::FilmTile& block : view.blocks) {
            const std::vector<std::byte> film = wire::encode_film(block);
            out.put(std::uint64_t{film.size()});
            out.put(film);
        }
    }
    return out.finish();
}

Expected<wire::CheckpointState> read_checkpoint(const std::filesystem::path& path, std::uint64_t number) {
    try {
        HashedFile file(path, CheckpointMagic, "checkpoint");
        return parse(file, number);
    } catch (const Error& error) {
        return failure(error.code(), "'" + path.string() + "': " + error.what());
    }
}

}  // namespace tessera::master
