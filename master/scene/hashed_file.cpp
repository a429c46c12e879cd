#include "master/scene/hashed_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <string>

#include "master/scene/session_folder.h"

namespace tessera::master {

namespace {

constexpr std::size_t HashBytes = 32;

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
                       const char* what) {
    const auto need = [](bool holds, const std::string& otherwise) {
        if (!holds) throw Error(ErrorCode::InvalidInput, otherwise);
    };
    std::ifstream file(path, std::ios::binary | std::ios::ate);
    if (!file) throw Error(ErrorCode::Io, std::string("cannot read it: ") + std::strerror(errno));
    bytes_.resize(static_cast<std::size_t>(file.tellg()));
    file.seekg(0);
    file.read(reinterpret_cast<char*>(bytes_.data()), static_cast<std::streamsize>(bytes_.size()));
    bytes_.resize(static_cast<std::size_t>(file.gcount()));
    need(bytes_.size() > magic.size() + HashBytes, "it ends too early");
    need(std::memcmp(bytes_.data(), magic.data(), magic.size()) == 0,
         std::string("it is no ") + what + ", or one of another version of Tessera");
    rest_ = std::span<const std::byte>(bytes_).first(bytes_.size() - HashBytes);
    const Hash256 hash = blake2b(rest_);
    need(std::memcmp(hash.bytes.data(), bytes_.data() + rest_.size(), HashBytes) == 0,
         "its checksum is wrong: it is torn or damaged");
    rest_ = rest_.subspan(magic.size());
}

std::span<const std::byte> HashedFile::take(std::uint64_t count) {
    if (count > rest_.size()) throw Error(ErrorCode::InvalidInput, "it ends too early");
    const auto part = rest_.first(count);
    rest_ = rest_.subspan(count);
    return part;
}

std::uint64_t HashedFile::number() {
    std::uint64_t value = 0;
    std::memcpy(&value, take(sizeof value).data(), sizeof value);
    return value;
}

}  // namespace tessera::master
