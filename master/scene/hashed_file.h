#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "master/scene/journal_file.h"
#include "mediator/base/error.h"
#include "mediator/base/hash.h"

namespace tessera::master {

// A file that is there in full or not at all: eight bytes that say what it is, the content, and the BLAKE2b hash of
// both. It is written beside its place, forced to the disk and renamed; a writer that is destroyed before takes back
// what it wrote. Every call throws Error{Io}, naming the file.
class HashedFileWriter {
  public:
    using Magic = std::array<char, 8>;

    HashedFileWriter(const std::filesystem::path& path, const Magic& magic);
    ~HashedFileWriter();
    HashedFileWriter(const HashedFileWriter&) = delete;
    HashedFileWriter& operator=(const HashedFileWriter&) = delete;

    void put(std::span<const std::byte> bytes);
    void put(std::uint64_t number) { put(std::as_bytes(std::span(&number, 1))); }
    std::uint64_t finish();  // its size

  private:
    void raw(std::span<const std::byte> bytes);

    std::filesystem::path path_, unfinished_;
    FileHandle file_;
    Blake2b hash_;
    std::uint64_t byte_size_ = 0;
    bool is_finished_ = false;
};

// The content. Throws Error{Io} when it cannot be read, Error{InvalidInput} when it is something else or damaged.
class HashedFile {
  public:
    HashedFile(const std::filesystem::path& path, const HashedFileWriter::Magic& magic, const char* what);

    // The next bytes; throws Error{InvalidInput} beyond the end.
    std::span<const std::byte> take(std::uint64_t count);
    std::uint64_t number();
    std::span<const std::byte> rest() const { return rest_; }

  private:
    std::vector<std::byte> bytes_;
    std::span<const std::byte> rest_;
};

}  // namespace tessera::master
