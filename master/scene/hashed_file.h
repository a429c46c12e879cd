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

// Writes a file atomically: an eight-byte magic, the content, and the BLAKE2b hash of both. It is written under a
// temporary name in the same folder, synced and renamed; a writer destroyed before finish() removes the temporary file.
// Every call throws Error{Io} with the file's name.
class HashedFileWriter {
  public:
    using Magic = std::array<char, 8>;

    HashedFileWriter(const std::filesystem::path& path, const Magic& magic);
    ~HashedFileWriter();
    HashedFileWriter(const HashedFileWriter&) = delete;
    HashedFileWriter& operator=(const HashedFileWriter&) = delete;

    void put(std::span<const std::byte> bytes);
    void put(std::uint64_t number) { put(std::as_bytes(std::span(&number, 1))); }
    std::uint64_t finish();  // returns the size

  private:
    void raw(std::span<const std::byte> bytes);

    std::filesystem::path path_, unfinished_;
    FileHandle file_;
    Blake2b hash_;
    std::uint64_t byte_size_ = 0;
    bool is_finished_ = false;
};

// Reads such a file: once to verify it, and then part by part, so that no more than one part is in memory. Throws
// Error{Io} if it cannot be read, Error{InvalidInput} if it has another magic or is damaged.
class HashedFile {
  public:
    HashedFile(const std::filesystem::path& path, const HashedFileWriter::Magic& magic, const char* what);

    // The next bytes; throws Error{InvalidInput} beyond the end.
    std::vector<std::byte> take(std::uint64_t count);
    std::uint64_t number();
    std::uint64_t remaining() const { return end_ - at_; }  // bytes

  private:
    FileHandle file_;
    std::uint64_t at_ = 0, end_ = 0;
};

}  // namespace tessera::master
