#include "master/scene/hashed_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <string>

#include "master/scene/session_folder.h"

namespace tessera::master {

namespace {

constexpr std::size_t HashBytes = 32;
constexpr std::uint64_t PieceBytes = std::uint64_t{1} << 20;

Error cannot_read() {
    return Error(ErrorCode::Io, std::string("cannot read it: ") + std::strerror(errno));
}

Error cannot_write(const std::filesystem::path& path) {
    return Error(ErrorCode::Io, "cannot write '" + path.string() + "': " + std::strerror(errno) +
                                    "; check the folder, its rights and the free space");
}

}  // namespace

HashedFileWriter::HashedFileWriter(const std::filesystem::path& path, const Magic& magic)
    : path_(path),
      unfinished_(path.string() + ".part"),
      file_(::open(unfinished_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600)) {
    if (file_.descriptor() < 0) throw cannot_write(unfinished_);
    put(std::as_bytes(std::span(magic)));
}

HashedFileWriter::~HashedFileWriter() {
    if (!is_finished_) ::unlink(unfinished_.c_str());
}

void HashedFileWriter::put(std::span<const std::byte> bytes) {
    hash_.update(bytes);
    raw(bytes);
}

std::uint64_t HashedFileWriter::finish() {
    raw(hash_.finish().bytes);
    if (::fsync(file_.descriptor()) != 0) throw cannot_write(unfinished_);
    if (std::rename(unfinished_.c_str(), path_.c_str()) != 0) throw cannot_write(path_);
    is_finished_ = true;
    force_to_disk(path_.parent_path());
    return byte_size_;
}

void HashedFileWriter::raw(std::span<const std::byte> bytes) {
    while (!bytes.empty()) {
        const ssize_t count = ::write(file_.descriptor(), bytes.data(), bytes.size());
        if (count < 0 && errno == EINTR) continue;
        if (count <= 0) throw cannot_write(unfinished_);
        bytes = bytes.subspan(static_cast<std::size_t>(count));
        byte_size_ += static_cast<std::uint64_t>(count);
    }
}

HashedFile::HashedFile(const std::filesystem::path& path, const HashedFileWriter::Magic& magic,
                       const char* what)
    : file_(::open(path.c_str(), O_RDONLY | O_CLOEXEC)) {
    const auto need = [](bool holds, const std::string& otherwise) {
        if (!holds) throw Error(ErrorCode::InvalidInput, otherwise);
    };
    if (file_.descriptor() < 0) throw cannot_read();
    const std::uint64_t size = size_of(file_);
    need(size > magic.size() + HashBytes, "it ends too early");
    end_ = size - HashBytes;
    const std::vector<std::byte> start = take(magic.size());
    need(std::memcmp(start.data(), magic.data(), magic.size()) == 0,
         std::string("it is no ") + what + ", or one of another version of Tessera");
    Blake2b hash;
    hash.update(start);
    while (at_ < end_) hash.update(take(std::min(PieceBytes, end_ - at_)));
    std::array<std::byte, HashBytes> stored{};
    const bool is_whole = read_at(file_, end_, stored);
    const Hash256 computed = hash.finish();
    need(is_whole && std::ranges::equal(stored, std::as_bytes(std::span(computed.bytes))),
         "its checksum is wrong: it is torn or damaged");
    at_ = magic.size();
}

std::vector<std::byte> HashedFile::take(std::uint64_t count) {
    if (count > remaining()) throw Error(ErrorCode::InvalidInput, "it ends too early");
    std::vector<std::byte> part(count);
    if (!read_at(file_, at_, part)) throw Error(ErrorCode::InvalidInput, "it ends too early");
    at_ += count;
    return part;
}

std::uint64_t HashedFile::number() {
    std::uint64_t value = 0;
    const std::vector<std::byte> bytes = take(sizeof value);
    std::memcpy(&value, bytes.data(), sizeof value);
    return value;
}

}  // namespace tessera::master
