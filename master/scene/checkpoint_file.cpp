#include "master/scene/checkpoint_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <span>

#include "master/scene/session_folder.h"
#include "mediator/wire/journal_codec.h"

namespace tessera::master {

namespace {

constexpr std::array<char, 8> CheckpointMagic{'T', 'S', 'C', 'H', 'E', 'C', 'K', '1'};
constexpr std::size_t HashBytes = 32;

Error cannot_write(const std::filesystem::path& path) {
    return Error(ErrorCode::Io, "cannot write '" + path.string() + "': " + std::strerror(errno) +
                                    "; check the folder, its rights and the free space");
}

// Writes and hashes.
class Output {
  public:
    explicit Output(const std::filesystem::path& path)
        : path_(path), file_(::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600)) {
        if (file_.descriptor() < 0) throw cannot_write(path_);
    }
    template <class T>
    void put(const T& value) {
        put(std::as_bytes(std::span(&value, 1)));
    }
    void put(std::span<const std::byte> bytes) {
        hash_.update(bytes);
        raw(bytes);
    }
    std::uint64_t finish() {
        raw(hash_.finish().bytes);
        if (::fsync(file_.descriptor()) != 0) throw cannot_write(path_);
        return byte_size_;
    }

  private:
    void raw(std::span<const std::byte> bytes) {
        while (!bytes.empty()) {
            const ssize_t count = ::write(file_.descriptor(), bytes.data(), bytes.size());
            if (count < 0 && errno == EINTR) continue;
            if (count <= 0) throw cannot_write(path_);
            bytes = bytes.subspan(static_cast<std::size_t>(count));
            byte_size_ += static_cast<std::uint64_t>(count);
        }
    }

    std::filesystem::path path_;
    FileHandle file_;
    Blake2b hash_;
    std::uint64_t byte_size_ = 0;
};

class Input {
  public:
    explicit Input(std::span<const std::byte> bytes) : rest_(bytes) {}
    std::span<const std::byte> take(std::uint64_t count) {
        if (count > rest_.size()) throw Error(ErrorCode::InvalidInput, "it ends too early");
        const auto part = rest_.first(count);
        rest_ = rest_.subspan(count);
        return part;
    }
    std::uint64_t number() {
        std::uint64_t value = 0;
        std::memcpy(&value, take(sizeof value).data(), sizeof value);
        return value;
    }
    bool at_end() const { return rest_.empty(); }

  private:
    std::span<const std::byte> rest_;
};

void need(bool holds, const char* otherwise) {
    if (!holds) throw Error(ErrorCode::InvalidInput, otherwise);
}

std::vector<std::byte> contents(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary | std::ios::ate);
    if (!file) throw Error(ErrorCode::Io, std::string("cannot read it: ") + std::strerror(errno));
    std::vector<std::byte> bytes(static_cast<std::size_t>(file.tellg()));
    file.seekg(0);
    file.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    bytes.resize(static_cast<std::size_t>(file.gcount()));
    return bytes;
}

wire::CheckpointState parse(std::span<const std::byte> file, std::uint64_t number) {
    need(file.size() > CheckpointMagic.size() + HashBytes, "it ends too early");
    need(std::memcmp(file.data(), CheckpointMagic.data(), CheckpointMagic.size()) == 0,
         "it is no checkpoint, or one of another version of Tessera");
    const auto body = file.first(file.size() - HashBytes);
    const Hash256 hash = blake2b(body);
    need(std::memcmp(hash.bytes.data(), file.data() + body.size(), HashBytes) == 0,
         "its checksum is wrong: it is torn or damaged");
    Input in(body);
    in.take(CheckpointMagic.size());
    need(in.number() == number, "it is another checkpoint than its name says");
    auto state = wire::decode_checkpoint(in.take(in.number()));
    if (!state) throw state.error();
    for (wire::SavedView& view : state->views) {
        for (; view.block_count > 0; --view.block_count) {
            auto film = wire::decode_film(in.take(in.number()));
            if (!film) throw film.error();
            view.blocks.push_back(std::move(*film));
        }
    }
    need(in.at_end(), "something follows its last block");
    return std::move(*state);
}

}  // namespace

std::uint64_t write_checkpoint(const std::filesystem::path& path, std::uint64_t number,
                               const wire::CheckpointState& state) {
    const std::filesystem::path unfinished = path.string() + ".part";
    std::uint64_t size = 0;
    try {
        Output out(unfinished);
        out.put(CheckpointMagic);
        out.put(number);
        const std::vector<std::byte> bytes = wire::encode(state);
        out.put(std::uint64_t{bytes.size()});
        out.put(std::span<const std::byte>(bytes));
        for (const wire::SavedView& view : state.views) {
            for (const frame::FilmTile& block : view.blocks) {
                const std::vector<std::byte> film = wire::encode_film(block);
                out.put(std::uint64_t{film.size()});
                out.put(std::span<const std::byte>(film));
            }
        }
        size = out.finish();
    } catch (...) {
        ::unlink(unfinished.c_str());
        throw;
    }
    if (std::rename(unfinished.c_str(), path.c_str()) != 0) {
        const Error error = cannot_write(path);
        ::unlink(unfinished.c_str());
        throw error;
    }
    force_to_disk(path.parent_path());
    return size;
}

Expected<wire::CheckpointState> read_checkpoint(const std::filesystem::path& path, std::uint64_t number) {
    try {
        return parse(contents(path), number);
    } catch (const Error& error) {
        return failure(error.code(), "'" + path.string() + "': " + error.what());
    }
}

}  // namespace tessera::master
